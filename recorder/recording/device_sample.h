// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements of a device, and their way into the recording. Frame D is the device's own.
#pragma once

#include <array>
#include <cstdint>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Bit of DeviceSample::buttons beyond those of InstrumentSample (sim/scene/samples.h): while it is held the instrument
/// rests, so that the hand can be put elsewhere.
inline constexpr std::uint8_t clutchButton = 1U << 7U;

/// One measurement of one hand, as the driver got it. Provenance: never rounded, never interpolated.
struct DeviceSample {
  std::int64_t deviceTime = -1;  ///< the device's own clock (ns); -1: it sends none
  std::int64_t hostTime = 0;     ///< when it was received, on the host's monotonic clock (ns)
  std::uint64_t sequence = 0;    ///< 0, 1, 2, ... for each hand and opening, invalid ones included
  Hand hand = Hand::right;
  Vec3 position = Vec3::Zero();         ///< p_DI (m)
  Quat orientation = Quat::Identity();  ///< q_DI, unit
  double gripper = 0.0;                 ///< opening angle (rad), 0 closed
  std::uint8_t buttons = 0;             ///< bits of calot::button, and clutchButton
  bool valid = true;                    ///< false: the pose means nothing (occluded, not finite, no rotation)
};

/// A measurement as the recording keeps it (schemas/recording.md, /device).
struct RawSample {
  DeviceSample sample;
  std::uint64_t tick = 0;  ///< first tick that could use it
  bool used = false;       ///< that tick's pose was made from it: the newest valid one of its hand, no clutch held
};

/// Queue from which the recording's writer takes raw samples, while another thread may put them in.
class RawSampleFeed {
 public:
  RawSampleFeed() = default;
  RawSampleFeed(const RawSampleFeed&) = delete;
  RawSampleFeed& operator=(const RawSampleFeed&) = delete;
  virtual ~RawSampleFeed() = default;

  /// Takes the next sample whose tick lies before `endTick`. One thread. @returns false where there is none now.
  virtual bool take(std::uint64_t endTick, RawSample& out) = 0;

  /// Samples of each hand that came and could not be kept, so far.
  [[nodiscard]] virtual std::array<std::uint64_t, handCount> dropped() const = 0;
};

}  // namespace calot::recorder

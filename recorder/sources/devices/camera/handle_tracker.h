// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/sources/devices/camera/camera_rig.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/handle_fit.h"

namespace calot::recorder {

/// Tags of one camera's frame.
struct SeenFrame {
  std::size_t camera = 0;
  std::int64_t time = 0;  ///< exposure of the middle row (ns)
  std::vector<SeenTag> tags;
};

/// Reason why a handle has no pose.
enum class PoseFault : std::uint8_t {
  none,
  unseen,        ///< too few of its tags
  ambiguous,     ///< two poses explain what was seen
  inconsistent,  ///< no pose explains all that was seen
  uncertain,     ///< one does, but the position would be too uncertain
  leap,          ///< too far from where the handle was
};
const char* wordsFor(PoseFault fault);

struct HandleSight {
  PoseFault fault = PoseFault::unseen;
  std::int64_t time = 0;  ///< that the pose is for: mean of the corners' exposures (ns)
  Pose pose;              ///< q_DI, p_DI
  double residual = 0.0;  ///< pixels
  double uncertainty = 0.0;
  std::optional<double> jaw;  ///< angle of the flap (rad); nothing: not seen, or not trusted
};

/// Limits of what is believed.
struct TrackerLimits {
  double residual = 1.0;        ///< root mean square (pixels)
  double tagResidual = 2.5;     ///< of one tag; one that is beyond is left out, if enough remain (pixels)
  double uncertainty = 0.0025;  ///< m
  double ambiguity = 4.0;       ///< cost of the second pose per cost of the best, at least
  double speed = 2.0;           ///< m/s
  double turning = 20.0;        ///< rad/s
};

/// Poses of one hand's handle from frame to frame. A pose is believed only if it explains all that was seen, no other
/// one does nearly as well, and the handle can have come there; anything else has no pose.
class HandleTracker {
 public:
  HandleTracker(const CameraRig& rig, Hand hand, TrackerLimits limits = {});

  /// @param frames of the same moment, at most one of each camera
  HandleSight track(std::span<const SeenFrame> frames);

 private:
  struct Known {
    std::int64_t time = 0;
    Pose pose;
  };
  std::vector<CornerSight> cornersOf(std::span<const SeenFrame> frames, std::int64_t time) const;
  PoseFault choose(const std::vector<CornerSight>& corners, std::int64_t time, PoseFit& best) const;
  [[nodiscard]] Pose predicted(std::int64_t time) const;
  [[nodiscard]] bool reachable(const Known& from, const Pose& to, std::int64_t time) const;
  [[nodiscard]] std::optional<double> jawOf(std::span<const SeenFrame> frames, const HandleSight& sight) const;

  const CameraRig* rig_;
  Hand hand_;
  TrackerLimits limits_;
  std::vector<std::vector<Vec3>> point_;  ///< corners of each rigid tag, in I
  std::optional<Known> last_;             ///< believed
  Twist twist_;
  std::vector<Known> waiting_;  ///< beyond reach of the last one, but each within reach of the one before it
};

}  // namespace calot::recorder

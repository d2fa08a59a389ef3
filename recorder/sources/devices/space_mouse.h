// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

/// A SpaceMouse through spacenavd, by libspnav: its deflections are speeds, so that an instrument stands where the cap
/// is let go.
///
/// D is x right, y down, z away. The cap moves the tip in all three directions, 60 mm/s at full deflection, and rolls
/// it about z, 1.5 rad/s; speed grows with the square of the deflection beyond a dead zone of 5 %. The first button
/// closes the jaw and the second opens it, at 1.2 rad/s; the third cuts or fires. 250 samples a second. One a program:
/// the daemon's library has one connection.
class SpaceMouse final : public Device {
 public:
  /// @throws Error (failure) where spacenavd does not answer, or another hand has it.
  explicit SpaceMouse(Hand hand, DeviceClock clock = monotonicNanoseconds);
  ~SpaceMouse() override;

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return there_; }
  void close() override;

 private:
  bool read();

  Hand hand_;
  DeviceInfo info_;
  DeviceClock clock_;
  std::array<double, 4> deflection_{};  ///< right, down, away, roll; 1 is full
  std::array<bool, 3> held_{};
  Vec3 position_ = Vec3::Zero();
  double roll_ = 0.0, jaw_ = 0.0;
  std::uint64_t sequence_ = 0;
  std::int64_t last_ = 0, nextAttempt_ = 0;
  bool there_ = false, open_ = true, greeted_ = false, mine_ = false;
};

extern const DeviceKind spaceMouseKind;

}  // namespace calot::recorder

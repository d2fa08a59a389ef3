// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "recorder/sources/devices/pointer_device.h"

namespace calot::recorder {

/// A SpaceMouse through spacenavd, by libspnav: its deflections are speeds, so that an instrument stands where the cap
/// is let go.
///
/// D is x right, y down, z away. The cap moves the tip in all three directions, 60 mm/s at full deflection, and rolls
/// it about z, 1.5 rad/s; speed grows with the square of the deflection beyond a dead zone of 5 %. The first button
/// closes the jaw and the second opens it, at 1.2 rad/s; the third cuts or fires. 250 samples a second. One a program:
/// the daemon's library has one connection.
class SpaceMouse final : public PointerDevice {
 public:
  /// @throws Error (failure) where spacenavd does not answer, or another hand has it.
  explicit SpaceMouse(Hand hand, DeviceClock clock = monotonicNanoseconds);
  ~SpaceMouse() override;

  [[nodiscard]] bool connected() const override { return there_; }
  void close() override;

 private:
  std::string find() override;
  std::string readControls() override;
  void advance(double seconds, std::int64_t now, DeviceInput& out) override;
  void disconnect() override;

  Hand hand_;
  std::array<double, 4> deflection_{};  ///< right, down, away, roll; 1 is full
  std::array<bool, 3> held_{};
  Pointer pointer_;
  bool there_ = false, mine_ = false;
};

extern const DeviceKind spaceMouseKind;

}  // namespace calot::recorder

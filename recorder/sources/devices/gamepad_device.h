// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/pointer_device.h"

namespace calot::recorder {

/// A gamepad as one pointer: its sticks are speeds, so that an instrument stands where they are let go.
///
/// D is x right, y down, z away. Left stick: x and y. Right trigger or right stick up: away; left trigger or right
/// stick down: back. Shoulders or right stick across: roll. Hat up and down: the jaw opens and closes. A fires, B
/// locks, X cuts, Y coagulates. Start passes the pointer to the other hand; the hand it leaves stands still and is not
/// measured. Full deflection is 60 mm/s, 1.5 rad/s, 1.2 rad/s; speed grows with the square of the deflection beyond a
/// dead zone of 12 %.
class GamepadDevice final : public PointerDevice {
 public:
  /// Takes the first gamepad whose name contains `name` (empty: any) and that no other device of this program has.
  /// @param only the hand that it drives, which Start then does not change; none: the right one first
  /// @throws Error (failure) where there is none, or where the system's gamepads cannot be asked.
  explicit GamepadDevice(const std::string& name = "", DeviceClock clock = monotonicNanoseconds,
                         std::optional<Hand> only = std::nullopt);
  ~GamepadDevice() override;

  [[nodiscard]] bool connected() const override;

 private:
  struct Sdl;
  std::string find() override;
  std::string readControls() override;
  void advance(double seconds, std::int64_t now, DeviceInput& out) override;
  void disconnect() override;

  std::unique_ptr<Sdl> sdl_;
  std::string name_;  ///< what the gamepad's name contains
  std::array<Pointer, handCount> pointer_;
  Hand hand_;
  bool bound_;              ///< to that hand
  bool switching_ = false;  ///< Start was held at the last sample
};

/// Names of the gamepads that are attached. @throws Error (failure) where the system cannot be asked.
std::vector<std::string> listGamepads();

extern const DeviceKind gamepadKind;

}  // namespace calot::recorder

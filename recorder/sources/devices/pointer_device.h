// SPDX-License-Identifier: GPL-3.0-or-later
// Devices that move a pointer: mice, gamepads, SpaceMice. D is x right, y down, z away.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

/// A pointer that drives one hand: where the tip is from where it began, its roll and its jaw.
struct Pointer {
  Vec3 position = Vec3::Zero();  ///< m, in D
  double roll = 0.0, jaw = 0.0;  ///< rad
  std::uint64_t sequence = 0;

  /// Moves within `reach` of where it began on each axis (m).
  void move(const Vec3& way, double reach);
  /// Opens the jaw by an angle, within [0, 1.2] rad.
  void openJaw(double angle);
  DeviceSample sample(Hand hand, std::int64_t now);
};

/// Sets a bit of a sample's buttons where it is held.
inline void press(std::uint8_t& buttons, bool held, unsigned bit) {
  if (held) buttons = static_cast<std::uint8_t>(buttons | bit);
}

/// 1, -1, or 0 where both or none are held.
inline double between(bool plus, bool minus) { return (plus ? 1.0 : 0.0) - (minus ? 1.0 : 0.0); }

/// Removes from what is asked for as much as may be done now.
double drawn(double& asked, double most);

/// Speed of a deflection in [-1, 1]: its square beyond the dead zone, with its sign.
double speedOf(double deflection, double deadZone);

/// The first 64 characters of a name, without control characters.
std::string nameFrom(const char* text);

/// A device whose controls are read 250 times a second.
class PointerDevice : public ReopeningDevice {
 public:
  void setOut(Hand hand, const HandStart& start) override {
    if (Pointer* const pointer = pointerOf(hand); pointer != nullptr) pointer->jaw = start.jaw;
  }

 protected:
  static constexpr std::int64_t period = 4'000'000;  ///< ns from sample to sample

  /// @param reach of a pointer, each way on each axis (m)
  PointerDevice(DeviceClock clock, const char* name, double reach);
  std::string connect() final;
  void read(std::chrono::nanoseconds wait, DeviceInput& out) final;
  /// The pointer of a hand, or null.
  virtual Pointer* pointerOf(Hand hand) = 0;
  /// Finds the device. @returns why it cannot be used, or an empty text
  virtual std::string find() = 0;
  /// Reads the controls. @returns why the device is lost, or an empty text
  virtual std::string readControls() = 0;
  /// Moves the pointer for `seconds`, and gives a sample.
  virtual void advance(double seconds, std::int64_t now, DeviceInput& out) = 0;

  std::int64_t last_;  ///< time of the last sample (ns)

 private:
  std::string loss_;  ///< the last one's reason
};

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
  Pointer* pointerOf(Hand hand) override { return hand == hand_ ? &pointer_ : nullptr; }
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
OpenedDevice openSpaceMouse(const DeviceRequest& request);

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
  Pointer* pointerOf(Hand hand) override { return &pointer_[static_cast<std::size_t>(hand)]; }
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

extern const DeviceKind gamepadKind;
OpenedDevice openGamepad(const DeviceRequest& request);
/// The gamepads that are attached. @throws Error (failure) where the system cannot be asked.
std::vector<ListedDevice> listGamepads();

}  // namespace calot::recorder

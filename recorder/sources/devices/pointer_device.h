// SPDX-License-Identifier: GPL-3.0-or-later
// Devices that move a pointer: mice, gamepads, SpaceMice. D is x right, y down, z away.
#pragma once

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
  /// The next sample, without buttons.
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
 protected:
  static constexpr std::int64_t period = 4'000'000;  ///< ns from sample to sample

  /// @param reach of a pointer, each way on each axis (m)
  PointerDevice(DeviceClock clock, const char* name, double reach);
  std::string connect() final;
  void read(std::chrono::nanoseconds wait, DeviceInput& out) final;
  /// Finds the device. @returns why it cannot be used, or an empty text
  virtual std::string find() = 0;
  /// Reads the controls. @returns why the device is lost, or an empty text
  virtual std::string readControls() = 0;
  /// Moves the pointer for so many seconds, and gives a sample.
  virtual void advance(double seconds, std::int64_t now, DeviceInput& out) = 0;

  std::int64_t last_;  ///< time of the last sample (ns)

 private:
  std::string loss_;  ///< the last one's reason
};

}  // namespace calot::recorder

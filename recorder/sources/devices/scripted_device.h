// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::recorder {

/// Safety gate before a motor: limits wrenches to the motor's range, rejects values that are not finite, and times out.
/// A loop that hangs must not leave a hand under force.
class WrenchGate {
 public:
  static constexpr std::int64_t watchdog = 50'000'000;  ///< ns without a command after which the wrench is zero

  /// @param maxForce N; @param maxTorque N m; both at least 0.
  WrenchGate(double maxForce, double maxTorque) : force_(maxForce), torque_(maxTorque) {}

  /// Force and torque are shortened to their largest length, keeping their direction; what is not finite becomes zero.
  void command(const Wrench& wrench, std::int64_t now);

  /// Current wrench for the motors.
  [[nodiscard]] Wrench output(std::int64_t now) const;

 private:
  double force_, torque_;
  Wrench wrench_;
  std::int64_t commanded_ = 0;
  bool any_ = false;
};

/// Plays a script on the clock that it is given: the same motion, the same unplugging, at the same ticks every time.
/// While it is unplugged its script pauses, as an operator would.
class ScriptedDevice final : public Device {
 public:
  /// @param clock (ns); the script begins when the device is made.
  ScriptedDevice(DeviceScript script, DeviceClock clock);

  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] bool ended() const override { return next_ == script_.samples.size(); }
  void setWrench(Hand hand, const Wrench& wrench) override;
  void close() override { open_ = connected_ = false; }

  /// Current force of its motors; zero if the script gives it none.
  [[nodiscard]] Wrench shown(Hand hand) const;

 private:
  DeviceScript script_;
  std::array<WrenchGate, handCount> gate_;
  std::int64_t origin_;   ///< clock at the script's time 0; moves on with every unplugging
  std::size_t next_ = 0;  ///< sample
  std::size_t unplugging_ = 0;
  bool connected_ = false, open_ = true, greeted_ = false;
};

extern const DeviceKind scriptedKind;

}  // namespace calot::recorder

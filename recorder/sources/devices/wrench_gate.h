// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/devices/device.h"

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

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// A stream of device samples as a file, which a scripted device plays or a calibration is measured
// from (format in docs/how-to/devices.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"

namespace calot::recorder {

struct DeviceScript {
  /// A labelled time interval for a calibration: rest, pivot, stroke x, stroke y, stroke z.
  struct Phase {
    std::string name;
    std::int64_t from = 0, to = 0;  ///< ns
  };
  /// The device is gone in [at, at + length).
  struct Unplugging {
    std::int64_t at = 0, length = 0;  ///< ns
  };

  std::string name;                   ///< of the device that made it, or that it stands for
  std::string file, sha256;           ///< base name, and of its bytes
  bool motionFile = false;            ///< read from the kinematics text format
  double rate = 0.0;                  ///< nominal (1/s); 0: unknown
  double maxForce = 0.0;              ///< N; above 0 the scripted device has motors
  std::vector<DeviceSample> samples;  ///< hostTime from 0, not falling
  std::vector<Unplugging> unpluggings;
  std::vector<Phase> phases;
};

/// Reads a script: JSON where the text begins with "{", else two-handed kinematics (readKinematics()), row
/// i at i/30 s.
/// @throws Error (damaged) with file and place.
DeviceScript readDeviceScript(const std::filesystem::path& file);
DeviceScript parseDeviceScript(std::span<const std::byte> bytes, const std::string& file);

/// The JSON text of a script; parseDeviceScript gives the same samples and phases back.
std::string deviceScriptText(const DeviceScript& script);

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

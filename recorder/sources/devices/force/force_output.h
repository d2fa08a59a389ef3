// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/force/energy_tank.h"

namespace calot::recorder {

/// What a device states of one of its handles.
struct HandleModel {
  TankModel force;   ///< N, m
  TankModel torque;  ///< N m, rad
};

/// What a device measured of a handle since the last measurement, and what its motors did meanwhile.
struct HandleMeasurement {
  Vec3 position = Vec3::Zero();  ///< m, in D
  Quat orientation = Quat::Identity();
  std::int64_t deviceTime = 0;  ///< ns
  std::uint32_t number = 0;     ///< of the wrench that was shown; 0: none
  Wrench shown;                 ///< by the motors, since the last measurement
  bool valid = true;
  bool clutched = false;
};

struct ForceStatistics {
  double maxForce = 0.0;          ///< N, of what was sent
  double maxChange = 0.0;         ///< N, from one wrench to the next
  double lowestEnergy = 0.0;      ///< J, of the tank
  std::uint64_t sent = 0;         ///< wrenches
  std::uint64_t softened = 0;     ///< of them, weaker than asked for, so that the port stays passive
  std::int64_t maxRoundTrip = 0;  ///< ns, from a wrench's sending until a pose said that it is shown
};

/// A line for people: "force on the left hand: ...".
std::string forceReport(const char* hand, const ForceStatistics& statistics);

/// What both hands' outputs did, for a thread that asks while another one drives the device.
class ForceReports {
 public:
  void note(std::size_t hand, const ForceStatistics& statistics);
  /// A line for each hand that was sent a wrench.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  mutable std::mutex mutex_;
  std::array<ForceStatistics, handCount> statistics_;
};

/// Between the simulation's force and a device's motors, for one hand. What is sent
///   - never exceeds the device's limits, and is finite;
///   - is passive (EnergyTank), whatever stiffness, delay and jitter there is;
///   - rises over 100 ms and falls over 30 ms where the hand appears, is lost, is clutched, where the simulation pauses
///     or is silent for 20 ms, and where the attempt ends; and changes by at most `maxSlew`, but where passivity asks
///     for less force.
///
/// It acts on the device alone: what is simulated and recorded has no part of it.
class ForceOutput {
 public:
  static constexpr std::int64_t silence = 20'000'000;  ///< ns without a command after which the force falls
  static constexpr double rise = 0.1, fall = 0.03;     ///< s
  static constexpr double maxSlew = 400.0;             ///< N/s, and 1/25 of it for torque (N m/s)

  explicit ForceOutput(const HandleModel& model);

  /// The simulation's wrench on the hand, in D. @param now ns, on the host's monotonic clock
  void command(const Wrench& wrench, std::int64_t now);
  /// A pose came. @returns the wrench to be sent now, which counts as command `number()`
  Wrench measured(const HandleMeasurement& measurement, std::int64_t now);
  [[nodiscard]] std::uint32_t number() const { return number_; }

  /// From here on the force falls to zero.
  void release() { released_ = true; }
  /// Has it fallen?
  [[nodiscard]] bool idle() const { return sent_.force.isZero() && sent_.torque.isZero(); }
  /// The device is gone: its motors are off by themselves. When it is back, the force rises anew.
  void lost();

  [[nodiscard]] const ForceStatistics& statistics() const { return statistics_; }

 private:
  [[nodiscard]] double gainAfter(const HandleMeasurement& measurement, std::int64_t now, double seconds) const;
  void noteRoundTrip(std::uint32_t shown, std::int64_t now);

  HandleModel model_;
  EnergyTank force_, torque_;
  Wrench asked_, sent_;
  std::int64_t commanded_ = 0;
  bool any_ = false, released_ = false;
  bool heard_ = false, seen_ = false;  ///< a measurement; one that is valid
  double gain_ = 0.0;
  Vec3 position_ = Vec3::Zero();
  Quat orientation_ = Quat::Identity();
  std::int64_t lastTime_ = 0, seenTime_ = 0;  ///< ns, of those
  std::uint32_t number_ = 0;
  std::uint32_t shown_ = 0;
  std::array<std::int64_t, 1024> sentAt_{};  ///< by number
  ForceStatistics statistics_;
};

}  // namespace calot::recorder

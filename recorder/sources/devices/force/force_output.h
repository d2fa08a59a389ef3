// SPDX-License-Identifier: GPL-3.0-or-later
// Passivity of a motor that is commanded once a period, over any delay. The energy that comes out of the port is
// measured as in a time-domain passivity observer (Hannaford and Ryu 2002; exact for a held force: Ryu, Kim and
// Hannaford 2004). It is bounded before it is spent, as by an energy-bounding algorithm (Kim and Ryu 2010) and the tank
// of a passivity layer (Franken, Stramigioli, Misra, Secchi and Macchelli 2011).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "sim/math/linear.h"

namespace calot::recorder {

/// Parameters of a motor and its mechanism, in one kind of effort: N, m, N s/m; or N m, rad, N m s/rad.
struct TankModel {
  double maxEffort = 0.0;
  double damping = 0.0;   ///< b, the least viscous damping that the mechanism has at its handle
  double friction = 0.0;  ///< c, the least Coulomb friction
  double quantum = 0.0;   ///< of the measured position, in each axis
  double period = 0.001;  ///< T, from one command to the next (s)
};

/// A held effort F does the work F . d over an interval in which the handle moves by d, of which the mechanism itself
/// dissipates at least b |d|^2 / T + c |d|. So whatever the hand does, an interval takes at most
///
///   R(F) = max(0, |F| - c)^2 T / (4 b)
///
/// out of the tank. An effort may be sent only if the tank holds R of it and of all efforts that were sent and whose
/// interval is not measured yet, however long they are on their way. Then the tank is never negative, and port and
/// mechanism together give the hand no more than `initial` beyond what it gave them: they are passive.
///
/// Positions are quantised: what the mechanism dissipates counts for the motion that is certain. A force that follows
/// quantised positions is still a function of the true ones and makes no energy of it.
class EnergyTank {
 public:
  static constexpr double initial = 0.0005;  ///< J, what it holds where nothing is touched
  static constexpr double trusted = 0.8;     ///< share of damping and friction that is counted on

  explicit EnergyTank(const TankModel& model);

  /// An interval has been measured. @param number of the command that was in force during it @param effort that the
  /// motor had @param displacement of the handle @param seconds its length
  void account(std::uint32_t number, const Vec3& effort, const Vec3& displacement, double seconds);

  /// Largest effort that may be sent now.
  [[nodiscard]] double bound() const;
  /// This effort was sent as command `number`; numbers rise.
  void sent(std::uint32_t number, double effort);
  /// Discards energy that this effort does not need, so that none is carried over.
  void settle(double wanted);
  /// The motor is off and all that was under way is void.
  void reset();

  [[nodiscard]] double level() const { return level_; }        ///< J; negative: more was spent than was bounded
  [[nodiscard]] double lowest() const { return lowest_; }      ///< J, since it was made
  [[nodiscard]] double reserved() const { return reserved_; }  ///< J

 private:
  struct Flight {
    std::uint32_t number = 0;
    double reserve = 0.0;
  };
  [[nodiscard]] double reserve(double effort) const;

  TankModel model_;
  double error_;  ///< largest error of a measured position
  double level_ = initial, lowest_ = initial, reserved_ = 0.0;
  // Commands under way: a second of them at 1 kHz would fit; more are not sent (bound() is 0).
  std::array<Flight, 1024> flight_{};
  std::size_t first_ = 0, count_ = 0;
};

/// Capabilities of one of a device's handles.
struct HandleModel {
  TankModel force;   ///< N, m
  TankModel torque;  ///< N m, rad
};

/// Measurement of a handle since the last one, and the work of its motors meanwhile.
struct HandleMeasurement {
  Vec3 position = Vec3::Zero();  ///< m, in D
  Quat orientation = Quat::Identity();
  std::int64_t deviceTime = 0;  ///< ns
  std::uint32_t number = 0;     ///< of the wrench that was shown; 0: none
  Wrench shown;                 ///< by the motors, since the last measurement
  bool valid = true;
  bool clutched = false;
};

/// Shortened to that length, keeping its direction; zero where it is not finite.
Vec3 limited(const Vec3& v, double longest);

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
  /// The device is gone: its motors are off by themselves. When it is back, the force rises again.
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

/// A device with motors: each hand's wrench goes through a ForceOutput.
class ForceFeedbackDevice : public ReopeningDevice {
 public:
  void setWrench(Hand hand, const Wrench& wrench) final;
  /// Lets the force fall to zero first, for at most a fifth of a second.
  void close() final;
  [[nodiscard]] std::array<ForceStatistics, handCount> forceStatistics() const final;

 protected:
  using ReopeningDevice::ReopeningDevice;
  /// The last message of an open connection, after the force has fallen.
  virtual void sayGoodbye() = 0;
  /// A pose came. @returns the wrench to be sent now @pre the hand has an output
  Wrench measured(std::size_t hand, const HandleMeasurement& measurement, std::int64_t now);
  void lose(const std::string& why, DeviceInput& out) final;

  std::array<std::optional<ForceOutput>, handCount> output_;

 private:
  mutable std::mutex mutex_;  ///< forceStatistics() may come from another thread
  std::array<ForceStatistics, handCount> statistics_;
  bool closed_ = false;
};

}  // namespace calot::recorder

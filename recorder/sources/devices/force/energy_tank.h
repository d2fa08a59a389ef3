// SPDX-License-Identifier: GPL-3.0-or-later
// Passivity of a motor that is commanded once a period, over any delay. The energy that comes out of the port is
// measured as in a time-domain passivity observer (Hannaford and Ryu 2002; exact for a held force: Ryu, Kim and
// Hannaford 2004). It is bounded before it is spent, as by an energy-bounding algorithm (Kim and Ryu 2010) and the tank
// of a passivity layer (Franken, Stramigioli, Misra, Secchi and Macchelli 2011).
#pragma once

#include <array>
#include <cstdint>

#include "sim/math/linear.h"

namespace calot::recorder {

/// What is known of a motor and its mechanism, in one kind of effort: N, m, N s/m; or N m, rad, N m s/rad.
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
  /// What is not needed for this effort is given up, so that no store of energy is carried into what comes.
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

}  // namespace calot::recorder

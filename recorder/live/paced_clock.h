// SPDX-License-Identifier: GPL-3.0-or-later
// Due times of ticks in real time, and stretching of the clock on a machine that is too slow.
#pragma once

#include <chrono>
#include <cstdint>

namespace calot::recorder {

using Nanoseconds = std::chrono::nanoseconds;

/// Time of the monotonic clock.
Nanoseconds monotonicNow();
/// Sleeps until that time (absolute, so that waking late once shifts nothing). A signal does not cut it short.
void sleepUntil(Nanoseconds time);
/// CPU time that the calling thread has used.
Nanoseconds threadCpuTime();

/// The tick clock: tick t is due t ms after the start, later by every pause and every stretch.
///
/// The lag of a run is how late its next tick is, and, where the simulation runs beside the ticks, for how many ticks
/// its next step has been computable beyond that. Lag is made up by running faster; if it exceeds maxLag, the
/// excess stretches the clock: all later ticks are postponed by it. On a machine that is always too slow, time thus
/// runs evenly slower, maxLag behind.
class PacedClock {
 public:
  static constexpr Nanoseconds tick = std::chrono::milliseconds(1);

  /// @param start when tick 0 is due
  explicit PacedClock(Nanoseconds start) : origin_(start) {}

  [[nodiscard]] Nanoseconds due(std::uint64_t t) const { return origin_ + static_cast<Nanoseconds::rep>(t) * tick; }

  /// May tick t begin? Stretches the clock by the excess of the lag over maxLag. If false, the simulation alone is
  /// that far behind: wait until due(t), which is then in the future, and call again.
  /// @param backlog ticks since the simulation's next step became computable; 0 or less: it is not waited for
  bool mayBegin(std::uint64_t t, Nanoseconds now, std::int64_t backlog);

  /// What is recorded as the lateness of tick t (s), given when its force was ready: TickOutcome::lateness. Ends the
  /// tick: the next mayBegin() is another's.
  float finish(std::uint64_t t, Nanoseconds ready);

  /// Postpones all ticks by the length of a pause.
  void pause(Nanoseconds length) { origin_ += length; }

  [[nodiscard]] std::uint64_t missed() const { return missed_; }      ///< ticks that ended after their deadline
  [[nodiscard]] Nanoseconds maxLateness() const { return largest_; }  ///< beyond due, of any tick
  [[nodiscard]] Nanoseconds stretched() const { return stretched_; }  ///< in all

 private:
  Nanoseconds origin_;
  Nanoseconds stretchedHere_{0};  // before the tick that has not finished yet
  Nanoseconds stretched_{0};
  Nanoseconds largest_{0};
  std::uint64_t missed_ = 0;
};

}  // namespace calot::recorder

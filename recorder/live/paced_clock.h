// SPDX-License-Identifier: GPL-3.0-or-later
// Due times of ticks in real time, stretching of the clock on a machine that is too slow, pauses, and costs of ticks.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>

#include "recorder/sources/source.h"

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

  /// Recorded lateness of tick t (s), given when its force was ready: TickOutcome::lateness. Ends the
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

/// Ticks of the whole, and thus recorded, steps of a run.
struct TickReport {
  std::uint64_t ticks = 0;
  std::uint64_t missedDeadlines =
      0;                     ///< paced: ticks whose force was ready later than tickDeadline after they were due
  double maxLateness = 0.0;  ///< of a tick (s)
  double stretched = 0.0;    ///< by how much the tick clock was stretched: lag beyond maxLag (s)

  void take(std::uint64_t done, const PacedClock& clock);
};

/// Number and length of the pauses of a run by its source.
struct SourcePauses {
  std::uint64_t count = 0;
  double seconds = 0.0;
};

/// Queries the source before a step; waits while it pauses, unless `stopped`, and postpones the clock accordingly.
/// @returns its status then.
SourceStatus waitWhilePaused(SampleSource& source, const std::function<bool()>& stopped, PacedClock& clock,
                             SourcePauses& pauses);

/// Mean and quantiles of many short durations, in fixed memory: bins of 250 ns up to 1 ms, and one for all above.
class CostHistogram {
 public:
  void add(std::chrono::nanoseconds cost) {
    const auto ns = static_cast<std::uint64_t>(std::max<std::chrono::nanoseconds::rep>(cost.count(), 0));
    ++bins_[std::min<std::size_t>(ns / width, bins_.size() - 1)];
    ++count_;
    sum_ += ns;
    largest_ = std::max(largest_, ns);
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// s; 0 of none
  [[nodiscard]] double mean() const {
    return count_ == 0 ? 0.0 : 1e-9 * static_cast<double>(sum_) / static_cast<double>(count_);
  }
  [[nodiscard]] double largest() const { return 1e-9 * static_cast<double>(largest_); }  ///< s
  /// Upper bound of quantile `part` (s): the upper edge of its bin, or the maximum if that is less. @pre part in [0, 1]
  [[nodiscard]] double quantile(double part) const {
    const double wanted = part * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i + 1 < bins_.size(); ++i) {
      seen += bins_[i];
      if (static_cast<double>(seen) >= wanted) return std::min(1e-9 * static_cast<double>((i + 1) * width), largest());
    }
    return largest();
  }

 private:
  static constexpr std::uint64_t width = 250;
  std::array<std::uint64_t, 4001> bins_{};
  std::uint64_t count_ = 0, sum_ = 0, largest_ = 0;
};

/// A run, as who makes its ticks sees it.
struct HapticReport : TickReport {
  Outcome outcome = Outcome::completed;
  SourcePauses pauses;
  bool realTime = false;  ///< live: the haptic thread ran before all ordinary threads (SCHED_FIFO)
  CostHistogram cost;     ///< live: thread CPU time of a tick, in which both hands' samples are taken and forces made
};

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// The 1 kHz loop on a thread of its own: samples in, forces out, everything to the simulation through a ring.
// Contact sets come the other way, with the memory that the haptic thread needs for them.
// Due times of ticks in real time, stretching of the clock on a machine that is too slow, pauses, and costs of ticks.
#pragma once

#include <semaphore.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <thread>

#include "recorder/base/queues.h"
#include "recorder/engine/observer.h"
#include "recorder/sources/source.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"

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

/// The part of a run's report that comes from the thread that makes its ticks.
struct HapticReport : TickReport {
  Outcome outcome = Outcome::completed;
  SourcePauses pauses;
  bool realTime = false;  ///< live: the haptic thread ran before all ordinary threads (SCHED_FIFO)
  CostHistogram cost;     ///< live: thread CPU time of a tick, in which both hands' samples are taken and forces made
};

using ContactSets = std::array<ContactSet, handCount>;
using HapticStates = std::array<HapticState, handCount>;
/// Capacity for each vector among the fields of a contact set or haptic state; vectors beyond maxVectors are not
/// tracked (they would grow in the haptic thread).
inline constexpr std::size_t maxVectors = 64;
using VectorSizes = std::array<std::size_t, maxVectors>;

/// Lock-free exchange of the newest contact sets of both hands. Sets are copied into slots whose memory is reused. When
/// a set is larger than any before, the simulation side prepares haptic states of sufficient capacity (by running a
/// tick on it) and publishes them as well; the haptic thread moves its state into them and so never allocates.
class ContactExchange {
 public:
  /// @param states, sets initial values of the haptic thread. @param model outlives the exchange.
  ContactExchange(const Model& model, const HapticStates& states, const ContactSets& sets);

  /// Simulation: publishes these sets. Allocates only if they grow (counted).
  void publish(const ContactSets& sets);
  /// Simulation: number of times a set was larger than any before.
  [[nodiscard]] std::uint64_t grown() const { return grown_; }

  /// Haptic thread: takes newer sets, if any, and capacity for them. Neither allocates nor locks.
  void refresh();
  [[nodiscard]] const ContactSets& sets() { return newest_.value().sets; }
  HapticStates& states() { return states_; }

 private:
  struct Slot {
    ContactSets sets;
    HapticStates room;
    std::uint64_t generation = 0;  // of the capacity
  };
  bool outgrown(const ContactSets& sets);
  void makeRoom(const ContactSets& sets);

  std::array<HapticModel, handCount> model_;
  Newest<Slot> newest_;
  HapticStates states_;        // the haptic thread's
  std::uint64_t adopted_ = 0;  // the haptic thread's: generation of its capacity
  std::atomic<std::uint64_t> seen_{0};

  // The simulation's: greatest size of each vector of a set so far, and haptic states of sufficient capacity.
  std::array<VectorSizes, handCount> most_{};
  HapticStates room_;
  std::uint64_t generation_ = 0, grown_ = 0;
};

/// Runs ticks at the rate of the tick clock, each with the newest published contact sets, until the source ends or
/// `gate` ends it. The simulation takes the ticks of one step after the other and publishes.
class HapticThread {
 public:
  struct Settings {
    /// Called before the first tick of every step of this run (0, 1, 2, ...): returns how the attempt
    /// ends here, or `running`.
    std::function<Outcome(std::uint64_t step)> gate;
    std::function<void(const TickOutcome&)> feedback;  ///< called with every tick's forces immediately; or empty
    const std::atomic<bool>* stop = nullptr;           ///< also queried while the source pauses
  };

  /// @param model, source outlive the thread; the source is used by it alone. @param states, sets as the
  /// session has them now.
  HapticThread(const Model& model, SampleSource& source, const HapticStates& states, const ContactSets& sets,
               Settings settings);
  ~HapticThread();
  HapticThread(const HapticThread&) = delete;
  HapticThread& operator=(const HapticThread&) = delete;

  /// Simulation: waits for the ticks of the next step. @param due when that step was due to begin. @returns false at
  /// the end: no step has all its ticks any more. Sizes of the spans: ticks a step.
  bool takeStep(std::span<TickSamples> samples, std::span<TickOutcome> outcomes, Nanoseconds& due);

  /// Simulation: the step whose ticks were taken last is done, and these are its sets.
  void stepDone(const ContactSets& sets);

  /// Simulation: waits for the thread's end. @throws what the source threw there.
  const HapticReport& finish();
  /// Simulation, after finish(): number of times that the sets exceeded the capacity.
  [[nodiscard]] std::uint64_t arenasGrown() const { return exchange_.grown(); }

 private:
  struct Tick {
    TickSamples samples;
    TickOutcome outcome;
    Nanoseconds due{0};
  };
  void run();
  void ticks();
  bool waitForSource();
  bool waitForTurn(std::uint64_t t);

  const Model& model_;
  SampleSource& source_;
  Settings settings_;
  std::uint32_t ticksPerStep_;
  std::array<HapticModel, handCount> hapticModel_;
  ContactExchange exchange_;
  Ring<Tick> ring_;
  PacedClock clock_;
  HapticReport report_;
  std::exception_ptr fault_;
  std::atomic<std::uint64_t> stepsDone_{0};
  std::atomic<bool> abandoned_{false};  // the simulation has stopped
  sem_t steps_{};                       // steps whose ticks are all in the ring, and one for the end
  std::thread thread_;
};

}  // namespace calot::recorder

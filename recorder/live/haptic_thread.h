// SPDX-License-Identifier: GPL-3.0-or-later
// The 1 kHz loop on a thread of its own: samples in, forces out, everything to the simulation through a ring.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <thread>

#include "recorder/base/ring.h"
#include "recorder/engine/observer.h"
#include "recorder/live/contact_exchange.h"
#include "recorder/live/cost_histogram.h"
#include "recorder/live/paced_clock.h"
#include "recorder/live/source_pause.h"
#include "recorder/sources/source.h"

namespace calot::recorder {

/// Statistics of the haptic thread. Ticks, deadlines and stretching are those of complete, and thus recorded, steps.
struct HapticReport {
  Outcome outcome = Outcome::completed;
  bool realTime = false;  ///< runs with real-time priority (SCHED_FIFO)
  std::uint64_t ticks = 0;
  std::uint64_t missedDeadlines = 0;
  double maxLateness = 0.0;  ///< s
  double stretched = 0.0;    ///< s
  SourcePauses pauses;
  CostHistogram cost;  ///< thread CPU time of a tick: both hands' samples taken and forces made
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

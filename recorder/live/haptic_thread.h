// SPDX-License-Identifier: GPL-3.0-or-later
// The 1 kHz loop on a thread of its own: samples in, forces out, everything to the simulation through a ring.
// Contact sets come the other way, with the memory that the haptic thread needs for them.
#pragma once

#include <semaphore.h>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <thread>

#include "recorder/base/queues.h"
#include "recorder/engine/observer.h"
#include "recorder/live/paced_clock.h"
#include "recorder/sources/source.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

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

// SPDX-License-Identifier: GPL-3.0-or-later
// The body of the one loop: ticks, then the step, then the observers. Live, scripted and replayed runs are this code.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/observer.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/scene/stepper.h"

namespace calot::recorder {

/// Step numbers of the contact sets that the ticks of a step used, per tick and hand.
using SetNumbers = std::vector<std::array<std::int64_t, handCount>>;

class Session {
 public:
  /// @param model, executor outlive the session.
  Session(const Model& model, std::uint64_t seed, Executor& executor);

  /// Observers are told of every step from here on, in the order of joining.
  void join(Observer& observer) { observers_.push_back(&observer); }

  /// Haptic tick of both hands for the i-th tick of the coming step.
  /// @param sets which contact sets to use; none: the newest (the previous step's).
  /// @throws std::out_of_range where a named set is not known any more, or not yet.
  TickOutcome tick(const TickSamples& samples,
                   const std::optional<std::array<std::int64_t, handCount>>& sets = std::nullopt);

  /// The step after its ticks; then tells the observers.
  void step(std::span<const TickSamples> samples, std::span<const TickOutcome> ticks, float lateness);

  void end(Outcome outcome);

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const State& state() const { return state_; }
  /// Steps done; the next step's number.
  [[nodiscard]] std::uint64_t steps() const { return state_.clock.step; }

  /// State, haptic states and contact sets after the last step. @pre steps() > 0
  [[nodiscard]] Keyframe keyframe() const;

  /// Goes on from a keyframe. @returns false, leaving all as it was, when its bytes do not fit the model.
  bool restore(const Keyframe& keyframe);

  [[nodiscard]] SceneView view() const { return viewOf(model_, state_); }

 private:
  static constexpr std::size_t keptSets = 64;
  using SetPair = std::array<ContactSet, handCount>;

  const Model& model_;
  State state_;
  Stepper stepper_;
  std::array<HapticModel, handCount> hapticModel_;
  std::array<HapticState, handCount> haptic_;
  std::deque<SetPair> sets_;  ///< newest last
  std::vector<Observer*> observers_;
};

}  // namespace calot::recorder

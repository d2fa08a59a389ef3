// SPDX-License-Identifier: GPL-3.0-or-later
// The body of the one loop: ticks, then the step, then the observers. Live, scripted and replayed runs are this code.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/engine/engine.h"
#include "recorder/engine/observer.h"
#include "recorder/engine/state_fields.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_viewer.h"
#include "sim/scene/state.h"
#include "sim/step/hand_haptics.h"
#include "sim/step/stepper.h"

namespace calot::recorder {

using ContactSets = std::array<ContactSet, handCount>;
using HapticStates = std::array<HapticState, handCount>;

class Session {
 public:
  /// How many steps' contact sets are at hand: more than a live run's ticks can lag behind (maxLag, in the shortest
  /// steps there are, of one tick).
  static constexpr std::size_t keptSets = 128;

  /// @param model, executor outlive the session. @param services of its stepper (PreparedScene::services())
  Session(const Model& model, std::uint64_t seed, Executor& executor, const StepperServices& services = {});

  /// Subscribes to every step from here on; observers are called in the order of joining.
  void join(Observer& observer) { observers_.push_back(&observer); }

  /// Unsubscribes. No effect if not subscribed.
  void leave(Observer& observer) { std::erase(observers_, &observer); }

  /// Called with the contact sets as soon as a step has made them, before any observer gets the step.
  void onContactSets(std::function<void(const ContactSets&)> tell) { tell_ = std::move(tell); }

  /// For live runs, before the first tick: see Stepper::precompute().
  void precompute() { stepper_.precompute(); }

  /// Haptic tick of both hands for the i-th tick of the coming step.
  /// @param sets which contact sets to use; none: the newest (the previous step's). Live, older ones come where the
  /// simulation was behind; a hand's numbers never fall from tick to tick.
  /// @throws std::out_of_range where a named set is not known any more, or not yet, or older than the tick before's.
  TickOutcome tick(const TickSamples& samples, const std::optional<NamedSets>& sets = std::nullopt);

  /// The step after its ticks; then notifies the observers. Where a tick is later than maxLag, the tick clock was
  /// stretched, and the step's events end with one EventKind::clockStretched: the sum over its ticks of the excess.
  EngineStep step(std::span<const TickSamples> samples, std::span<const TickOutcome> ticks, float lateness);

  /// A whole step: its ticks, then the step. @param input its `logged` names contact sets and lateness of each tick;
  /// empty: each tick uses the newest set and is in time
  EngineStep run(const StepInput& input);

  void end(Outcome outcome);

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const State& state() const { return state_; }
  /// Steps done; the next step's number.
  [[nodiscard]] std::uint64_t steps() const { return state_.clock.step; }

  /// State and haptic states after the last step, and the contact sets that later ticks may name: those from the one
  /// that the step's last tick used on, since numbers never fall. @pre steps() > 0
  [[nodiscard]] Keyframe keyframe() const;

  /// Goes on from a keyframe. @returns false, leaving all as it was, when its bytes do not fit the model.
  /// @param named the contact sets that the last tick before used; none: the oldest that the keyframe has, which a hand
  /// that lagged less than the other has left behind
  bool restore(const Keyframe& keyframe, const std::optional<NamedSets>& named = std::nullopt);

  /// Haptic states after the last tick, and the newest contact sets: what a haptic thread begins with.
  [[nodiscard]] const HapticStates& haptics() const { return haptic_; }
  [[nodiscard]] const ContactSets& contactSets() const { return setsOf(newest_); }

  [[nodiscard]] SceneView view();

 private:
  [[nodiscard]] const ContactSets& setsOf(std::int64_t step) const {
    return sets_[static_cast<std::size_t>(step + 1) % keptSets];
  }
  [[nodiscard]] ContactSets& setsOf(std::int64_t step) { return sets_[static_cast<std::size_t>(step + 1) % keptSets]; }
  const StepResult& withStretch(const StepResult& result, std::span<const TickOutcome> ticks);

  const Model& model_;
  State state_;
  Stepper stepper_;
  std::array<HapticModel, handCount> hapticModel_;
  HapticStates haptic_;
  std::vector<ContactSets> sets_;  ///< of step n at (n + 1) % keptSets: slots keep their memory
  std::int64_t oldest_ = -1;       ///< steps whose sets are at hand
  std::int64_t newest_ = -1;
  NamedSets named_{-1, -1};  ///< by the last tick
  StepResult flagged_;
  std::function<void(const ContactSets&)> tell_;
  std::vector<Observer*> observers_;
  std::vector<TickOutcome> ticks_;       ///< of run()
  std::unique_ptr<SceneViewer> viewer_;  ///< once something is drawn
};

/// This program's own simulation.
class LocalEngine final : public Engine {
 public:
  /// @param model, executor outlive the engine. @param services of its session's stepper
  LocalEngine(const Model& model, Executor& executor, const StepperServices& services = {})
      : model_(model), executor_(&executor), services_(services) {}
  /// Goes on with a session that is there, which outlives the engine. @pre nobody calls start()
  explicit LocalEngine(Session& session) : model_(session.model()), session_(&session) {}

  [[nodiscard]] const DigestLayout& layout() const override { return model_.layout(); }
  void start(std::uint64_t seed) override;
  [[nodiscard]] bool restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) override;
  [[nodiscard]] std::uint64_t steps() const override { return session_ != nullptr ? session_->steps() : 0; }
  EngineStep step(const StepInput& input) override { return session_->run(input); }
  [[nodiscard]] Keyframe keyframe() override { return session_->keyframe(); }
  [[nodiscard]] SceneView view() override { return session_->view(); }
  [[nodiscard]] std::optional<KeyframeDifference> explain(const Keyframe& recorded) override {
    return differenceOf(model_, recorded, session_->keyframe());
  }

  /// @pre start() or restore()
  [[nodiscard]] const Session& session() const { return *session_; }

 private:
  const Model& model_;
  Executor* executor_ = nullptr;
  StepperServices services_;
  std::unique_ptr<Session> owned_;
  Session* session_ = nullptr;
};

}  // namespace calot::recorder

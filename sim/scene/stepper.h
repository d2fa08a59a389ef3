// SPDX-License-Identifier: GPL-3.0-or-later
// step(Model, State, samples) -> StepResult, with the memory that it works in.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "sim/contact/broad_phase.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/scene/step_result.h"

namespace calot {

/// Computes steps. Holds caches and arenas, nothing that a State does not determine: two steppers over the same State
/// give the same bits, whatever they did before, with any executor and any broad phase.
class Stepper {
 public:
  using MakeBroadPhase = std::unique_ptr<BroadPhase> (*)();

  /// @param executor outlives the stepper. @param makeBroadPhase one is made for each organ.
  Stepper(const Model& model, Executor& executor, MakeBroadPhase makeBroadPhase = nullptr);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Works out ahead what steps else work out when they first need it (compliances of the skins' nodes, rest tables of
  /// folding organs): for live runs, which cannot wait for it in mid-step. Changes no result. Of organs whose
  /// compliances would take more than 256 MiB, nothing is worked out ahead.
  void prepare();

  /// Advances the state by one step. Never throws on any sample: what is not finite counts as not measured.
  /// @pre samples.size() == ticksPerStep
  const StepResult& step(State& state, std::span<const TickSamples> samples);

  /// The contact problem that the last step published for a hand.
  [[nodiscard]] const ContactSet& contactSet(std::size_t hand) const;

  /// Digest of the state after the last step; hashes only what the step wrote.
  const StateDigest& digest(const State& state);

  /// To be called when the State was replaced (restored) since the last step.
  void invalidate();

 private:
  struct Workspace;
  std::unique_ptr<Workspace> w_;
};

/// Haptic state of a hand before the first tick.
HapticState initialHaptics(const Model& model, const State& state, std::size_t hand);

/// Takes one tick's sample: the real pose is the sample through workspace and port; held where the sample is no
/// measurement.
void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics);

/// What the haptic tick needs of a hand of this model.
HapticModel hapticModel(const Model& model, std::size_t hand);

/// Surfaces, instruments and camera of a state.
SceneView viewOf(const Model& model, const State& state);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// step(Model, State, samples) -> StepResult: ten stages (stages.h).
#pragma once

#include <memory>
#include <span>

#include "sim/contact/broad_phase.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/state.h"
#include "sim/scene/step_result.h"
#include "sim/solid/solid.h"

namespace calot {

/// Parts of a stepper that its user may supply. They change how fast steps are computed, no result.
struct StepperServices {
  /// Cache of rest compliances shared with other steppers of the same model; null: the stepper's own. Outlives it.
  ComplianceStore* compliances = nullptr;
  MakeBroadPhase makeBroadPhase = nullptr;  ///< called once for each structure; null: SortedGrid
};

/// Computes steps. Holds caches and scratch memory, nothing that a State does not determine: two steppers over the same
/// State give the same bits, whatever they did before, with any executor and any broad phase.
class Stepper {
 public:
  /// @param model, executor outlive the stepper
  Stepper(const Model& model, Executor& executor, const StepperServices& services = {});
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Computes ahead what steps otherwise compute on first use (compliances of the skins' nodes, tables of the reference
  /// configuration of folding organs): for live runs, which cannot wait for it in mid-step. Changes no result. Organs
  /// whose compliances would take more than 256 MiB are left out.
  void precompute();

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
  struct Pipeline;
  std::unique_ptr<Pipeline> p_;
};

}  // namespace calot

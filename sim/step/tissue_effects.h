// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 8 of a step: what instruments and tension did to the tissue.
#pragma once

#include "sim/step/cautery.h"
#include "sim/step/connective_effects.h"
#include "sim/step/vessel_tools.h"

namespace calot {

/// Strands burn and tear, jaws set clips and cut, the hook carves fat, chars organs and burns vessels.
///
/// Reads: poses and surfaces after stage 7, travels. Writes: topology and damage in State (strands, clips, partings,
/// carved fields, char), what is written and disturbed in `activity`, the results of fat, connective tissue and
/// cautery.
class TissueEffects {
 public:
  explicit TissueEffects(const Model& model)
      : model_(model), search_(model), connective_(model), tools_(model), cautery_(model) {}

  /// @pre surfaces are current
  void run(const InstrumentTravels& travels, Surfaces& surfaces, Bodies& bodies, State& state, Activity& activity,
           StepResult& result, StepLog& log) {
    sweepHooks(model_, travels, state, sweeps_);
    for (std::size_t h = 0; h < handCount; ++h) search_.run(sweeps_[h], bodies, surfaces, state, touches_[h]);
    connective_.run(sweeps_, touches_, bodies, state, activity, result, log);
    tools_.run(bodies, surfaces, state, activity, log);
    cautery_.run(sweeps_, touches_, bodies, surfaces, state, activity, result, log);
  }

 private:
  const Model& model_;
  HookTouchSearch search_;
  ConnectiveEffects connective_;
  VesselTools tools_;
  CauteryEffects cautery_;
  HookSweeps sweeps_;
  std::array<HookTouches, handCount> touches_;
};

}  // namespace calot

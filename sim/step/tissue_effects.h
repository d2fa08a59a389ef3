// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 8 of a step: what instruments and tension did to the tissue.
#pragma once

#include <vector>

#include "sim/step/bodies.h"
#include "sim/step/hook_touches.h"
#include "sim/step/step_log.h"
#include "sim/step/tissue_damage.h"

namespace calot {

// Effects of the energised hook on fat, organs and vessels. Internal to this folder.
//
// Every place that is touched (HookTouches) counts the time that it got the full power. There are two counts. The
// wall's exposure decides what opens or parts; the coagulating current adds to it at `coagulationPace`. Char counts the
// time of coagulation; the cutting current adds to it at `cutChar`. Neither depends on the mesh, and neither can
// shrink.

class CauteryEffects {
 public:
  explicit CauteryEffects(const Model& model) : model_(model) {}

  /// Fills `cautery` of the hands and `carved`, `islands` of the fat. @pre surfaces are those after the step
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
           Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  /// Data shared by all parts of a run.
  struct Tissue {
    Bodies& bodies;
    Surfaces& surfaces;
    State& state;
    Activity& activity;
    StepResult& result;
    StepLog& log;
  };
  /// Full power of a whole step of touch (s).
  struct Dose {
    double wall = 0.0;
    double charring = 0.0;
  };
  void burnHand(const HookSweep& sweep, const HookTouches& touches, std::size_t hand, Tissue& tissue);
  void charOrgans(const HookTouches& touches, const Dose& dose, Tissue& tissue) const;
  void burnVessels(const HookTouches& touches, const Dose& dose, std::size_t hand, Tissue& tissue) const;
  void carve(const HookSweep& sweep, const Dose& dose, std::size_t hand, std::size_t fat, Tissue& tissue);
  void findTied(std::size_t fat, const Bodies& bodies);
  [[nodiscard]] std::uint32_t firstTouched(const HookTouches& touches, const Tissue& tissue) const;
  void emitSmoke(std::size_t hand, std::uint32_t source, double energy, Tissue& tissue) const;

  const Model& model_;
  std::vector<SweptCapsule> blades_;  ///< of the hook, as fat feels them
  std::vector<std::size_t> tied_;     ///< bodies that carried some of the fat before a stroke
};

// Effects of a step on connective tissue. Internal to this folder.

/// Burns the strands that the energised hooks touch; damages and tears those that are pulled too hard.
class ConnectiveEffects {
 public:
  explicit ConnectiveEffects(const Model& model) : model_(model) {}

  /// @pre organs and instruments are where the step leads them
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies, State& state,
           Activity& activity, StepResult& result, StepLog& log);

 private:
  const Model& model_;
  std::vector<std::uint32_t> strands_;
};

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

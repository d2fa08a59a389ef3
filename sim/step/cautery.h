// SPDX-License-Identifier: GPL-3.0-or-later
// What the energised hook does to fat, organs and vessels. Internal to this folder.
//
// Every place that is touched (HookTouches) counts the time that it got the full power. There are two counts. The
// wall's exposure decides what opens or parts; the coagulating current adds to it at `coagulationPace`. Char counts the
// time of coagulation; the cutting current adds to it at `cutChar`. Neither depends on the mesh, and neither can
// shrink.
#pragma once

#include "sim/step/hook_touches.h"
#include "sim/step/tissue_damage.h"

namespace calot {

class CauteryEffects {
 public:
  explicit CauteryEffects(const Model& model) : model_(model) {}

  /// Fills `cautery` of the hands and `carved`, `islands` of the fat. @pre surfaces are those after the step
  void run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
           Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  /// What all parts of a run work on.
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

}  // namespace calot

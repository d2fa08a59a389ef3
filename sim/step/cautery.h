// SPDX-License-Identifier: GPL-3.0-or-later
// What the energised hook does to fat, organs and vessels. Internal to this folder.
//
// Char is a count of how long each spot was under current. A touch gives its time to the corners of the triangle that
// it is on, by barycentric weights; a corner that stands for an area A of skin counts A / spot touches until it is
// charred as long as one spot would be. So the charred area grows by `spot` for each charTime of touch whatever the
// mesh, and can never shrink. Energy is power times time of touch.
#pragma once

#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/step/hook_motion.h"
#include "sim/step/tissue_damage.h"

namespace calot {

class CauteryEffects {
 public:
  explicit CauteryEffects(const Model& model) : model_(model) {}

  /// Fills `cautery` of the hands and `carved`, `islands` of the fat.
  /// @param burned per hand, the connective tissue that its hook burns. @pre surfaces are those after the step
  void run(const HookSweeps& sweeps, const std::array<std::uint32_t, handCount>& burned, Bodies& bodies,
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
  void burnHand(const std::vector<HookSweep>& sweeps, std::uint32_t connective, std::size_t hand, Tissue& tissue);
  bool carve(const std::vector<HookSweep>& sweeps, std::size_t hand, std::size_t fat, Tissue& tissue);
  void burnVessel(std::size_t hand, std::size_t structure, const SurfaceContact& contact, double time,
                  Tissue& tissue) const;
  void charOrgan(std::size_t structure, const SurfaceContact& contact, double time, Tissue& tissue) const;
  void emitSmoke(std::size_t hand, std::uint32_t source, double energy, Tissue& tissue) const;

  const Model& model_;
  std::vector<SweptCapsule> blades_;  ///< of the hook, as fat feels them
  std::vector<SurfaceContact> found_;
};

}  // namespace calot

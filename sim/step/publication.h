// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 9 of a step: StepResult, and the counters of State that follow from the whole step.
#pragma once

#include <vector>

#include "sim/step/contact_solution.h"
#include "sim/step/grasping.h"

namespace calot {

/// Reads: everything that the stages before left. Writes: StepResult of tissue and hands; sleep counters;
/// when each touch began; grasps that slip or tear.
class Publication {
 public:
  /// @param grasping outlives this. @param bodies whose fat is uncarved yet
  Publication(const Model& model, Grasping& grasping, const Bodies& bodies);
  /// @pre surfaces are current but for what stage 8 changed
  void run(const ContactSystem& contact, Surfaces& surfaces, Bodies& bodies, State& state, Activity& activity,
           StepResult& result, StepLog& log);

  /// The guard of last resort, after everything else: reports that the simulation ran away, and where.
  /// @param diverged per body, see ContactResponse
  void reportRunaway(const Bodies& bodies, const Activity& activity, const std::vector<bool>& diverged,
                     const State& state, StepLog& log) const;

 private:
  void publishOrgans(const ContactSystem& contact, Bodies& bodies, const Activity& activity, State& state,
                     StepResult& result) const;
  void publishVessels(const ContactSystem& contact, Surfaces& surfaces, Bodies& bodies, Activity& activity,
                      State& state, StepResult& result, StepLog& log) const;
  void publishVessel(const Bodies& bodies, bool awake, const State& state, std::size_t tree, std::size_t branch,
                     VesselResult& out) const;
  void publishFat(const ContactSystem& contact, Bodies& bodies, const Activity& activity, State& state,
                  StepResult& result) const;
  void publishHand(const ContactSystem& contact, std::size_t hand, State& state, HandResult& out, StepLog& log) const;

  void publishClash(const ContactSystem& contact, State& state, StepResult& result, StepLog& log) const;
  void publishConnective(const State& state, StepResult& result) const;
  [[nodiscard]] double shareLeft(const Bodies& bodies, std::size_t fat, std::size_t region) const;

  const Model& model_;
  Grasping& grasping_;
  /// Per body of fat: volumes of its regions before anything is carved (m^3).
  std::vector<std::vector<double>> wholeRegion_;
};

}  // namespace calot

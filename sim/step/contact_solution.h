// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 6 of a step: contact forces.
#pragma once

#include <array>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/penetration_resolver.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Solves the complementarity problem on the estimated compliance W, lets the tissue follow the change of forces by its
/// own matrix, corrects W by what that showed, and solves again with the gaps that are left, as often as the scene
/// allows.
///
/// Reads: the problem of stage 5. Writes: `contact.lambda` and `carried` (equal at the end), `freeGap`, velocities of
/// the bodies, solver figures of the result.
class ContactSolution {
 public:
  explicit ContactSolution(const Model& model) : model_(model) {}
  void run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels, ContactSystem& contact,
           ContactResult& result, StepLog& log);

 private:
  void solve(const ContactProblem& problem, ContactSystem& contact, ContactResult& result);
  void gatherImpulses(Bodies& bodies, const ContactSystem& contact, std::size_t which);
  void reportMiss(const Bodies& bodies, std::size_t which, const SolveReport& report, StepLog& log);
  void applyToGroup(Bodies& bodies, const Activity& activity, const ContactSystem& contact, std::size_t group,
                    StepLog& log);
  void applyContactImpulses(Bodies& bodies, const Activity& activity, const ContactSystem& contact, StepLog& log);
  std::array<double, 2> measureResponse(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                                        ContactSystem& contact);
  void updateComplianceEstimate(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                                ContactSystem& contact, StepLog& log);

  const Model& model_;
  ContactSolver solver_;
  bool loose_ = false;  ///< does another pass go on from the present one's solves?
  std::vector<double> gap_, change_;
  std::vector<double> gapBefore_, dimpleBefore_, forces_, expected_, response_;
  std::vector<Vec3> nodal_;
};

// Stage 7 of a step: bodies and instruments move, and the haptic loop gets its contact problem.

using ContactSets = std::array<ContactSet, handCount>;

/// Reads: velocities, contact forces, travels. Writes: positions and velocities of State, simulated poses, the warm
/// start, forces on the instruments, the contact sets for the ticks to come; surfaces are current afterwards.
class ContactResponse {
 public:
  explicit ContactResponse(const Model& model) : model_(model), resolver_(model), diverged_(model.bodies(), false) {}

  void run(Surfaces& surfaces, Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
           const ContactSystem& contact, State& state, ContactSets& sets, StepResult& result, StepLog& log);

  /// Per body: it met numbers that are not finite in this step.
  [[nodiscard]] const std::vector<bool>& diverged() const { return diverged_; }

 private:
  void integrateTissue(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state, StepLog& log);
  void integrateInstrument(std::size_t hand, const InstrumentTravel& travel, const ContactSystem& contact, State& state,
                           HandResult& result) const;

  const Model& model_;
  PenetrationResolver resolver_;
  std::vector<bool> diverged_;
};

/// The step's problem reduced to one hand. The other hand's forces, and those among tissue, stay as they are. Where
/// the instruments touch, the other one yields by its coupling and goes on as it moved in this step.
/// @pre bodies and instruments have moved
void reduceToHand(const Bodies& bodies, const State& state, const InstrumentTravels& travels,
                  const ContactSystem& contact, std::size_t hand, std::uint64_t step, ContactSet& set);

}  // namespace calot

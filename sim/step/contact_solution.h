// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 6 of a step: contact forces.
#pragma once

#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"

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

}  // namespace calot

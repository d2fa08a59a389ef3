// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 4 of a step: the unconstrained motion of all tissue.
#pragma once

#include <vector>

#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"

namespace calot {

/// One implicit step of each awake body under gravity, ties, connective tissue and retraction, and under the contact
/// forces that the last step left: vessels first, then organs (those that connective tissue ties as one system), which
/// take the vessels that are grown to them along, then fat. A body solved later sees the new velocities of those before
/// it.
///
/// Reads: State, `contact.carried`. Writes: rotations of State, contact-free velocities (Body::freeVelocity()),
/// residuals and iterations of the result.
class UnconstrainedMotion {
 public:
  explicit UnconstrainedMotion(const Model& model) : model_(model), solved_(model.bodies(), false) {}
  void run(Bodies& bodies, const ContactSystem& contact, const Activity& activity, State& state, StepResult& result,
           StepLog& log);

 private:
  void solveVessels(Bodies& bodies, const ContactSystem& contact, const Activity& activity, std::size_t tree,
                    State& state, StepLog& log);
  void solveGroup(Bodies& bodies, const ContactSystem& contact, const Activity& activity, std::size_t group,
                  State& state, StepResult& result, StepLog& log);
  void reportMiss(const Bodies& bodies, std::size_t which, const SolveReport& report, StepLog& log);
  void gatherLoads(Bodies& bodies, const ContactSystem& contact, const Activity& activity, const State& state,
                   std::size_t which);
  void gatherTies(const Bodies& bodies, const Activity& activity, const State& state, std::size_t which);
  void gatherRetractions(const Bodies& bodies, const State& state, std::size_t organ);
  [[nodiscard]] Vec3 endOf(const Bodies& bodies, const State& state, const Tie& tie, std::size_t side) const;

  const Model& model_;
  std::vector<bool> solved_;             ///< per body: in this step already
  std::vector<Vec3> nodal_;              ///< forces of contact on the body at hand (N)
  std::vector<Attachment> attachments_;  ///< of the body at hand
  std::vector<JointAttachment> joints_;
  std::vector<TieLoad> tieLoads_;
};

}  // namespace calot

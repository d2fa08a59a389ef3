// SPDX-License-Identifier: GPL-3.0-or-later
// Organs that connective tissue ties, solved as one linear system. Internal to this folder.
//
// Strands add to each organ's own matrix on the diagonal (Attachment) and couple the organs beside it (PointCoupling):
// implicit Euler of the whole, with forces that are equal and opposite. Conjugate gradients run over all organs of a
// group at once, preconditioned by each organ's own sweeps.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/solid/point_coupling.h"
#include "sim/step/organ_body.h"

namespace calot {

class JoinedOrgans {
 public:
  /// @param organs of the model, in its order @param settings, responses of the solves for motion and for impulses
  JoinedOrgans(const Model& model, std::vector<OrganBody*> organs, const SolidSolver::Settings& settings,
               const SolidSolver::Settings& responses);

  /// Groups the organs by the tissues that hold them together, and linearises the strands over the step. Tissues of
  /// sleeping organs are left out. @param awake per body
  void linearise(const State& state, const std::vector<bool>& awake);

  /// Organs that are solved together, ascending; groups by their first organ. An organ that nothing ties is a group of
  /// its own. @pre linearise()
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& groups() const { return group_; }

  /// Appends the attachments by which an organ feels its strands. @pre linearise()
  void addAttachments(std::size_t organ, std::vector<Attachment>& out) const;

  /// Solves the motion of a group. @pre OrganBody::assembleUnconstrained() of each of its organs
  SolveReport solveUnconstrained(std::size_t group) { return solve(group, settings_); }
  /// Solves the response to impulses. @pre OrganBody::takeImpulses() of each of its organs
  SolveReport applyImpulses(std::size_t group) { return solve(group, responses_); }

 private:
  /// A tissue's part in the system of its group.
  struct Tissue {
    std::unique_ptr<PointCoupling> coupling;
    ConnectiveLoads loads;
    bool holds = false;  ///< is any strand attached?
  };
  SolveReport solve(std::size_t group, const SolidSolver::Settings& settings);

  const Model& model_;
  std::vector<OrganBody*> organ_;
  SolidSolver::Settings settings_, responses_;
  std::vector<Tissue> tissue_;
  std::vector<std::size_t> first_;  ///< per organ: the first of its group
  std::vector<std::vector<std::size_t>> group_;
  std::vector<SolidSolver*> solver_;
  std::vector<SolidSolver::Coupled> coupled_;
};

}  // namespace calot

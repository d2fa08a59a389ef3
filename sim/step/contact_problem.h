// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 5 of a step: gaps and compliance of the contact problem.
//
// Tissue moved under the forces of the last step. What has to change is decided on a cheap compliance (that of the
// reference configuration, rotated with the nodes), applied by the step's own matrix in one solve for all forces
// together, and decided again with the gaps that this left (stage 6). A force that stays as it is costs nothing and
// carries no error of the compliance: at rest the gaps are those of the true equilibrium.
#pragma once

#include <vector>

#include "sim/scene/state.h"
#include "sim/solid/block_matrix.h"
#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"

namespace calot {

/// Rows whose gap stays wider take no part (m). Larger: more rows; smaller: contacts that close within the step are
/// missed. Assumed: half of contactMargin.
inline constexpr double openGap = 0.0005;

/// By which organs sink into each other for the force at a contact point (m/N): a skin softer than the mesh can show.
/// Larger: visible overlap; smaller: rows that repeat each other. Assumed.
inline constexpr double tissueSoftness = 1e-3;

/// Gaps that the bodies' present velocities lead to, instruments at their real poses and pushed by `lambda`:
/// `contact.trueGap`.
void measureGaps(const Model& model, const Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                 ContactSystem& contact);

/// W = estimate of the tissue + virtual couplings, with a small regularisation of its diagonal.
void sumCompliances(ContactSystem& contact);

/// Reads: contact-free velocities, rotations, travels. Writes: drops blocks that stay open; rows, gaps and compliances
/// of `contact`.
class ContactProblemStage {
 public:
  explicit ContactProblemStage(const Model& model) : model_(model) {}
  /// @return the largest violation of a row before any force changes (m)
  double run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels, const State& state,
             ContactSystem& contact);

 private:
  /// One body's part of a block: its nodes with weight and rotation, and the sign with which it opens the gap.
  struct Part {
    std::size_t block, body;
    double sign;
    const SolidSolver::Impulse* place;
    std::size_t rotations;                      // of its nodes: weight times rotation
    std::size_t coupling = ContactBlock::none;  // that the body takes part in
    std::vector<Mat3> responses;                // relative velocities of the coupling's ties
    std::vector<Mat3> impulses;                 // with which the ties respond
    [[nodiscard]] std::span<const int> nodes() const { return {place->node.data(), place->count}; }
  };

  double dropOpenBlocks(ContactSystem& contact) const;
  std::vector<Part> partsOf(Bodies& bodies, const Activity& activity, const State& state, const ContactSystem& contact);
  void assembleTissue(Bodies& bodies, const std::vector<Part>& parts, ContactSystem& contact);
  void assembleCouplings(ContactSystem& contact) const;

  const Model& model_;
  std::vector<RotatedColumns> rotations_;
  std::vector<double> nodeBlocks_;
};

// Contact forces from step to step: the warm start of the contact problem. Internal to this folder.

/// Numbers the rows and looks up the forces of the last step at the same contact points, projected onto what each block
/// admits: `carried` and `lambda`.
void loadWarmStart(const State& state, ContactSystem& contact);

/// Stores the forces by contact point for the next step.
void storeWarmStart(const ContactSystem& contact, State& state);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws that close on tissue grasp it: points of a structure's skin between them are tied to the instrument (bilateral
// blocks of the contact problem). They slip where the pull exceeds what the grip holds, and tear out above another
// force. Internal to this folder.
#pragma once

#include <vector>

#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"

namespace calot {

class Grasping {
 public:
  explicit Grasping(const Model& model) : model_(model), resolver_(model) {}

  /// Before the instruments move: discards grasped points whose fat was carved away, and releases what open jaws or
  /// exchanged instruments held. Writes HandState's grasp. @pre surfaces are current
  void release(Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact);
  /// After they moved: jaws that were open and close now grasp the tissue between them. @pre surfaces are current
  void close(Surfaces& surfaces, State& state, StepLog& log) const;
  /// A bilateral block for each grasped point, added to `blocks`. @pre surfaces are current
  void addBlocks(const Surfaces& surfaces, const State& state, std::vector<ContactBlock>& blocks) const;
  /// After the step: tissue that slipped or tore out. Fills each hand's `grasping` and `graspForce`; an organ that
  /// tears is opened. @pre surfaces are current
  void settle(Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log);

 private:
  void removeStaleGrasps(Surfaces& surfaces, std::size_t hand, State& state, StepLog& log, ContactResult& contact);
  void end(Surfaces& surfaces, std::size_t hand, EventKind why, double value, State& state, StepLog& log,
           ContactResult& contact);
  void closeOne(Surfaces& surfaces, std::size_t hand, State& state, StepLog& log) const;
  /// Moves slipping points along; discards those that left the jaws. @return whether any slips
  bool slip(const Surfaces& surfaces, std::size_t hand, State& state) const;
  [[nodiscard]] double heldFor(const HandState& hand, const State& state) const {
    return static_cast<double>(state.clock.step - hand.graspSince) * model_.stepSeconds();
  }

  const Model& model_;
  PenetrationResolver resolver_;
};

}  // namespace calot

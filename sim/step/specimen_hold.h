// SPDX-License-Identifier: GPL-3.0-or-later
// Fat that still holds the specimen. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/step/bodies.h"

namespace calot {

/// Does fat join the specimen of the scene's procedure with what stays?
///
/// Of two sides the first is the specimen and every piece of a vessel that is grown to it alone. The other is what
/// stays: all other organs, and every piece of a vessel that is grown to one of them or fixed. Whole vessels and
/// strands that join both sides are other facts of the step's result. A body of fat holds the specimen if connected fat
/// leads from one side to the other, by ties that are not wholly carved away; a loose piece of vessel leads on from one
/// part of the fat to another. Fat that hangs on one side alone holds nothing.
///
/// Asked again only after a step that carved, tore or parted something. Without a specimen nothing holds it.
class SpecimenHold {
 public:
  explicit SpecimenHold(const Model& model);

  /// To be called when the State was replaced.
  void invalidate() { known_ = false; }
  /// Reads: partings of vessels, fat and its ties, `reshaped` of the activity. Writes: `holdsSpecimen` of the result's
  /// fat.
  void run(Bodies& bodies, const Activity& activity, const State& state, StepResult& result);

 private:
  void findPieces(const State& state);

  const Model& model_;
  std::size_t specimen_;              ///< organ; none: the number of organs
  std::vector<std::size_t> first_;    ///< per tree of vessels: its first node among those of all trees
  std::vector<std::uint32_t> piece_;  ///< per node: the first node of its piece
  std::vector<std::uint32_t> side_;   ///< per node that is the first of a piece: its side, or a number of its own
  std::vector<std::uint32_t> thing_;  ///< per tie of the fat at hand: what it hangs on
  std::vector<bool> holds_;           ///< per body of fat
  bool known_ = false;
};

}  // namespace calot

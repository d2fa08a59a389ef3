// SPDX-License-Identifier: GPL-3.0-or-later
// Clip appliers and scissors on vessels. Internal to this folder.
#pragma once

#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"
#include "sim/step/tissue_damage.h"

namespace calot {

/// What happens when the jaws of clip appliers and scissors, opened before, close. Whatever a hand can do is done and
/// reported; nothing is refused.
class VesselTools {
 public:
  explicit VesselTools(const Model& model) : model_(model) {}
  void run(Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log);

 private:
  /// Where a vessel runs between jaws.
  struct Crossing {
    std::size_t structure = ContactBlock::none;
    BeamPoint place;
    double depth = 0.0;  ///< of its centre line from the jaws' crotch (m)
    double sine = 1.0;   ///< of the angle between vessel and jaws
    Pose frame;          ///< centre line there
  };

  [[nodiscard]] Crossing vesselBetween(const State& state, std::size_t hand, double length) const;
  bool isGripped(const State& state, std::size_t hand, const Crossing& crossing);
  void closeOne(std::size_t hand, Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log);
  void setClipOn(std::size_t hand, const Crossing& crossing, Bodies& bodies, State& state, Activity& activity,
                 StepLog& log) const;

  const Model& model_;
  PlacedInstrument instrument_;
};

}  // namespace calot

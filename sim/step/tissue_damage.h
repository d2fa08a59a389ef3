// SPDX-License-Identifier: GPL-3.0-or-later
// Damage that more than one stage does: organs opened, vessels parted. Internal to this folder.
#pragma once

#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"
#include "sim/step/instrument_clash.h"
#include "sim/step/step_log.h"
#include "sim/step/surfaces.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// Opens an organ that has a wall to be opened, once. @param exposure cautery there (s); 0: torn
void perforateOrgan(const Model& model, std::size_t organ, const Vec3& where, double exposure, State& state,
                    Activity& activity, StepLog& log);

/// Parts a vessel; reports it, what that leaves open, and the clips on either side of a cut.
/// @param kind vesselCut or vesselBurned
void partVessel(const Model& model, std::size_t structure, const BeamPoint& where, EventKind kind, std::size_t hand,
                Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log);

/// Reports what a vessel that tore in this step leaves open. @param element that tore
void reportTear(const Model& model, std::size_t tree, std::size_t element, State& state, StepLog& log);

// Clip appliers and scissors on vessels. Internal to this folder.

/// Effects of the jaws of clip appliers and scissors when they close after having been opened. Whatever a hand can do
/// is done and reported; nothing is refused.
class VesselTools {
 public:
  explicit VesselTools(const Model& model) : model_(model) {}
  void run(Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log);

 private:
  /// Part of a vessel that runs between jaws.
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

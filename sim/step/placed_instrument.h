// SPDX-License-Identifier: GPL-3.0-or-later
// A hand's instrument as capsules in W, and how far its jaws may sink into tissue. Internal to this folder.
#pragma once

#include <vector>

#include "sim/instruments/instrument_shape.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"

namespace calot {

/// Simulated pose of a hand's instrument: p_WI, q_WI.
inline Pose simulatedPose(const HandState& hand) { return {hand.simulatedPosition, hand.simulatedOrientation}; }

/// The instrument's capsules at a pose.
struct PlacedInstrument {
  InstrumentShape local;         ///< in I
  Pose pose;                     ///< p_WI, q_WI
  Vec3 port = Vec3::Zero();      ///< p_WP (m)
  std::vector<Capsule> capsule;  ///< in W

  void place(const HandDescription& hand, InstrumentKind kind, const Pose& at, double jaw);
};

/// At which a hand's hook divides tissue now, of the cutting current's pace; 0 without current.
double currentPace(const CauteryDescription& cautery, const HandState& hand);

/// How deep this part of the instrument may stand in a structure (m): jaws in what they grasp, because a mesh does not
/// fold between them, and in a vessel that they close a clip on, because a tube does not flatten between them; an
/// energised electrode in fat, as far as that recedes in a step; 0 otherwise.
double allowedDepth(const Model& model, const State& state, std::size_t hand, const Capsule& capsule,
                    std::size_t structure);

}  // namespace calot

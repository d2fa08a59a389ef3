// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/placed_instrument.h"

#include "sim/vessel/centre_line.h"

namespace calot {

namespace {

/// That jaws may sink into what they grasp (m): about the thickness of a fold of gallbladder wall. Larger: the
/// instrument sticks in tissue after release; smaller: tissue is pushed out of closing jaws. Assumed.
constexpr double graspedDepth = 0.0035;
/// The same about a clip (m): deeper than any vessel is thick. Larger changes nothing.
constexpr double crushedDepth = 0.02;

/// Are these the jaws of an applier that has closed, and not opened since, about a clip of this vessel? They crush what
/// they clip; blunt bodies that closed on a tube which cannot give way would throw it about.
bool isClosedOnClip(const Model& model, const State& state, const HandState& hand, std::size_t structure) {
  const StructureModel& s = model.structures()[structure];
  if (s.kind != tissueId<VesselTissue> || hand.jawsOpened) return false;
  if (instrumentOf(hand.instrument).action != InstrumentAction::clip) return false;
  const BeamModel& beams = model.vesselTrees()[s.index].beams;
  const BeamState& vessels = state.vessel[s.index];
  const double reach = 1.5 * model.scene().clip.legs;
  for (std::size_t c = 0; c < vessels.clips(); ++c) {
    if (vessels.clipBranch[c] != s.branch) continue;
    const Vec3 where = centreLine(beams, vessels, pointAt(beams, s.branch, vessels.clipPlace[c])).position;
    if ((where - hand.simulatedPosition).squaredNorm() < reach * reach) return true;
  }
  return false;
}

}  // namespace

double currentPace(const CauteryDescription& cautery, const HandState& hand) {
  if (instrumentOf(hand.instrument).action != InstrumentAction::burn) return 0.0;
  if ((hand.buttons & button::cutPedal) != 0) return 1.0;
  return (hand.buttons & button::coagulatePedal) != 0 ? cautery.coagulationPace : 0.0;
}

void PlacedInstrument::place(const HandDescription& hand, InstrumentKind kind, const Pose& at, double jaw) {
  const double length = (at.position - hand.port).norm();
  local = instrumentShape(kind, jaw, hand.shaftRadius, length);
  pose = at;
  port = hand.port;
  const InstrumentShape world = placed(local, pose);
  capsule.assign(world.capsules().begin(), world.capsules().end());
}

double allowedDepth(const Model& model, const State& state, std::size_t hand, const Capsule& capsule,
                    std::size_t structure) {
  if (capsule.part == Capsule::Part::electrode && model.structures()[structure].kind == tissueId<FatTissue>)
    return currentPace(model.scene().cautery, state.hand[hand]) * model.scene().cautery.recession * model.stepSeconds();
  const bool jaw = capsule.part == Capsule::Part::upperJaw || capsule.part == Capsule::Part::lowerJaw;
  if (!jaw) return 0.0;
  const HandState& h = state.hand[hand];
  if (isClosedOnClip(model, state, h, structure)) return crushedDepth;
  return h.grasped == structure ? graspedDepth : 0.0;
}

}  // namespace calot

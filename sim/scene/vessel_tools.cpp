// SPDX-License-Identifier: GPL-3.0-or-later
// Clip appliers and scissors on vessels: what happens when their jaws, opened before, close. Whatever a hand can do is
// done and told; nothing is refused.
#include "sim/math/no_fused_pairs.h"  // first

#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/math/elementary.h"
#include "sim/scene/stepper_workspace.h"
#include "sim/vessel/centre_line.h"
#include "sim/vessel/clips.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double jawRoom = 0.002;      ///< between jaws beside a vessel that they still close on (m)
constexpr double gripRoom = 0.0005;    ///< between blades and vessel where they count as touching (m)
constexpr double bladeLength = 0.012;  ///< of scissors, from their tips (m)

}  // namespace

/// The vessel that runs nearest to the line between the jaws, if any does so within reach.
/// @param length of that line, from the tips backwards (m)
Stepper::Workspace::Crossing Stepper::Workspace::vesselBetween(const State& state, std::size_t hand,
                                                               double length) const {
  Crossing best;
  const Pose tool = simulated(state, hand);
  const Vec3 along = tool.orientation * Vec3::UnitZ();
  double least = 1e300;
  for (std::size_t s = model.organs().size(); s < model.structures().size(); ++s) {
    const StructureModel& structure = model.structures()[s];
    if (structure.kind != StructureKind::vessel) continue;
    const BeamModel& beams = model.vesselTrees()[structure.index].beams;
    const BeamState& now = state.vessel[structure.index];
    const BeamModel::Branch& branch = beams.branches()[structure.branch];
    // A vessel that is partly beyond the tips or behind the crotch counts with that part.
    const double beyond = pinchedSection(branch.section, 1.0).wide;
    const Vec3 crotch = tool.position - (length + beyond) * along;
    const Vec3 tips = tool.position + beyond * along;
    for (std::size_t e = branch.firstElement; e < branch.firstElement + branch.elements(); ++e) {
      if (now.parting[e] != Parting::none) continue;
      const BeamElement& element = beams.elements()[e];
      const SegmentSegment close = closestSegments(crotch, tips, now.position[static_cast<std::size_t>(element.a)],
                                                   now.position[static_cast<std::size_t>(element.b)]);
      const double reach_ = branch.section.outerRadius + jawRoom;
      if (!(close.squaredDistance < least) || close.squaredDistance > reach_ * reach_) continue;
      least = close.squaredDistance;
      best.structure = s;
      best.place.branch = structure.branch;
      best.place.element = e;
      best.place.share = close.t;
      const std::size_t i = e - branch.firstElement;
      best.place.place = branch.place[i] + close.t * (branch.place[i + 1] - branch.place[i]);
      best.depth = close.s * (length + 2.0 * beyond) - beyond;
    }
  }
  if (best.structure == ContactBlock::nobody) return best;
  const std::size_t tree = model.structures()[best.structure].index;
  best.frame = centreLine(model.vesselTrees()[tree].beams, state.vessel[tree], best.place);
  const double cosine = along.dot(best.frame.orientation * Vec3::UnitZ());
  best.sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
  return best;
}

/// Do both blades touch the vessel where it crosses them? It is then cut: blades that went on closing as blunt bodies
/// would only push it out.
bool Stepper::Workspace::isGripped(const State& state, std::size_t hand, const Crossing& crossing) {
  const StructureModel& structure = model.structures()[crossing.structure];
  const BeamModel& beams = model.vesselTrees()[structure.index].beams;
  const double outer = beams.branches()[structure.branch].section.outerRadius;
  shapeAt(state, hand, simulated(state, hand), state.hand[hand].jaw);
  bool upper = false;
  bool lower = false;
  for (const Capsule& c : shape) {
    if (c.part != Capsule::Part::upperJaw && c.part != Capsule::Part::lowerJaw) continue;
    const Vec3& centre = crossing.frame.position;
    const Vec3 nearest = c.p0 + closestOnSegment(centre, c.p0, c.p1) * (c.p1 - c.p0);
    if ((nearest - centre).norm() > c.radius + outer + gripRoom) continue;
    (c.part == Capsule::Part::upperJaw ? upper : lower) = true;
  }
  return upper && lower;
}

/// Are these the jaws of an applier that has closed, and not opened since, about a clip of this vessel? They crush what
/// they clip; blunt bodies that closed on a tube which cannot give way would throw it about.
bool Stepper::Workspace::isClosedOnClip(const State& state, const HandState& hand, std::size_t structure) const {
  const StructureModel& s = model.structures()[structure];
  if (hand.instrument != InstrumentKind::clipApplier || hand.jawsOpened || s.kind != StructureKind::vessel)
    return false;
  const BeamModel& beams = model.vesselTrees()[s.index].beams;
  const BeamState& vessels = state.vessel[s.index];
  const double reach_ = 1.5 * model.scene().clip.legs;
  for (std::size_t c = 0; c < vessels.clips(); ++c) {
    if (vessels.clipBranch[c] != s.branch) continue;
    const Vec3 where = centreLine(beams, vessels, placeAt(beams, s.branch, vessels.clipPlace[c])).position;
    if ((where - hand.simulatedPosition).squaredNorm() < reach_ * reach_) return true;
  }
  return false;
}

void Stepper::Workspace::closeOnVessels(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  const bool clips = h.instrument == InstrumentKind::clipApplier;
  if (!h.jawsOpened || (!clips && h.instrument != InstrumentKind::scissors)) return;
  const bool closed = h.realJaw <= closedJaw || (clips && (h.buttons & button::fire) != 0);
  if (!closed && (clips || h.realJaw > cuttingJaw)) return;
  const Crossing crossing = vesselBetween(state, hand, clips ? model.scene().clip.legs : bladeLength);
  if (clips) {
    setClipOn(state, hand, crossing);
  } else if (crossing.structure != ContactBlock::nobody && isGripped(state, hand, crossing)) {
    cutVessel(state, hand, crossing);
  } else if (!closed) {
    return;
  }
  h.jawsOpened = false;
}

void Stepper::Workspace::setClipOn(State& state, std::size_t hand, const Crossing& crossing) {
  HandState& h = state.hand[hand];
  if (h.clips == 0) return;
  --h.clips;
  const auto drop = [&] { emit(EventKind::clipDropped, hand, 0, h.simulatedPosition, static_cast<double>(h.clips)); };
  if (crossing.structure == ContactBlock::nobody) {
    drop();
    return;
  }
  const StructureModel& structure = model.structures()[crossing.structure];
  const BeamModel& beams = model.vesselTrees()[structure.index].beams;
  BeamState& vessels = state.vessel[structure.index];
  const ClipDescription& clip = model.scene().clip;
  ClipAttempt attempt;
  attempt.place = crossing.place;
  attempt.width = clip.width;
  // A vessel that runs askew takes up more of the legs.
  attempt.legs = clip.legs * crossing.sine;
  attempt.depth = crossing.depth * crossing.sine;
  const Vec3 closing = crossing.frame.orientation.conjugate() * (h.simulatedOrientation * Vec3::UnitY());
  attempt.roll = arctangent2(closing[1], closing[0]);
  const ClipJudgement judged = judgeClip(beams, vessels, attempt, {clip.leastGap, clip.leastJunctionGap});
  if (judged.missed) {
    drop();
    return;
  }
  setClip(beams, vessels, attempt, judged.enclosed);
  disturb(state, structure.body);
  const auto subject = static_cast<std::uint16_t>(crossing.structure);
  const Vec3& where = crossing.frame.position;
  emit(EventKind::clipSet, hand, subject, where, judged.enclosed);
  if (judged.halfOn) emit(EventKind::clipHalfOn, hand, subject, where, judged.enclosed);
  if (judged.onClip) emit(EventKind::clipOnClip, hand, subject, where, -judged.clipGap);
  if (judged.nearClip || judged.nearJunction || judged.onEdge) {
    const double gap_ =
        std::min(judged.nearClip ? judged.clipGap : 1e300, judged.nearJunction ? judged.junctionGap : 1e300);
    emit(EventKind::clipTooNear, hand, subject, where, judged.onEdge ? 0.0 : gap_);
  }
}

void Stepper::Workspace::cutVessel(State& state, std::size_t hand, const Crossing& crossing) {
  // Blades part what they enclose: the centre line must be between them.
  if (crossing.depth < 0.0 || crossing.depth > bladeLength) return;
  partVessel(state, crossing.structure, crossing.place, Parting::cut, EventKind::vesselCut, hand);
}

/// Parts a vessel and tells of it and of what that opens.
void Stepper::Workspace::partVessel(State& state, std::size_t structure, const BeamPlace& where, Parting how,
                                    EventKind kind, std::size_t hand) {
  const StructureModel& s = model.structures()[structure];
  const VesselTree& tree = model.vesselTrees()[s.index];
  BeamState& vessels = state.vessel[s.index];
  const CutJudgement judged = judgeCut(tree.beams, vessels, where);
  const Vec3 place = centreLine(tree.beams, vessels, where).position;
  if (!part(vessels, where, how)) return;
  disturb(state, s.body);
  for (std::size_t b = 0; b < tree.vessel.size(); ++b) bounded[structureOf(s.index, b)] = false;
  const auto subject = static_cast<std::uint16_t>(structure);
  emit(kind, hand, subject, place, where.place);
  if (judged.opensBefore || judged.opensAfter) {
    emit(EventKind::cutOpen, hand, subject, place, (judged.opensBefore ? 1.0 : 0.0) + (judged.opensAfter ? 2.0 : 0.0));
  }
  for (std::size_t d = 0; d < model.procedure().divide.size(); ++d) {
    if (kind != EventKind::vesselCut || model.procedure().divide[d].structure != structure) continue;
    const DivideDescription& wanted = model.scene().procedure.divide[d];
    const std::size_t patient = wanted.patientAtStart ? judged.before : judged.after;
    const std::size_t specimen = wanted.patientAtStart ? judged.after : judged.before;
    const std::size_t missing = wanted.patient - std::min<std::size_t>(patient, wanted.patient) + wanted.specimen -
                                std::min<std::size_t>(specimen, wanted.specimen);
    if (missing > 0) emit(EventKind::tooFewClips, hand, subject, place, static_cast<double>(missing));
  }
  if (judged.throughClip) emit(EventKind::cutThroughClip, hand, subject, place, where.place);
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/tissue_effects.h"

#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

/// EventKind::cutOpen's value: which sides are open.
double openSides(const CutSides& cut) { return (cut.opensBefore ? 1.0 : 0.0) + (cut.opensAfter ? 2.0 : 0.0); }

/// Share of what parted the wall that has to be coagulation for the artery to be closed. Assumed.
constexpr double sealingShare = 0.5;

/// Coagulation closes a small artery that it divides; it never closes a duct reliably.
bool isSealed(const Model& model, std::size_t structure, const BeamState& vessels, const BeamPoint& where) {
  const StructureModel& s = model.structures()[structure];
  const VesselTree& tree = model.vesselTrees()[s.index];
  const BeamModel::Branch& branch = tree.beams.branches()[s.branch];
  if (carriesBile(s.role) || branch.section.outerRadius > model.scene().cautery.sealRadius) return false;
  const auto station = std::min(static_cast<std::size_t>(where.arcLength / branch.spacing()), branch.stations - 1);
  const double through = model.scene().vessels[tree.vessel[s.branch]].burnThrough;
  return vessels.charring[branch.firstStation + station] >= sealingShare * through;
}

}  // namespace

void perforateOrgan(const Model& model, std::size_t organ, const Vec3& where, double exposure, State& state,
                    Activity& activity, StepLog& log) {
  if (!(model.scene().organs[organ].burnThrough > 0.0) || state.charred[organ].perforated) return;
  state.charred[organ].perforated = true;
  activity.charred[organ] = true;
  log.emit(EventKind::organPerforated, StepLog::noHand, organ, where, exposure);
}

void partVessel(const Model& model, std::size_t structure, const BeamPoint& where, EventKind kind, std::size_t hand,
                State& state, Activity& activity, StepLog& log) {
  const StructureModel& s = model.structures()[structure];
  const VesselTree& tree = model.vesselTrees()[s.index];
  BeamState& vessels = state.vessel[s.index];
  const CutSides cut = cutSides(tree.beams, vessels, where);
  const Vec3 place = centreLine(tree.beams, vessels, where).position;
  if (!part(vessels, where, kind == EventKind::vesselCut ? Parting::cut : Parting::burned)) return;
  activity.reshape(s.body);
  log.emit(kind, hand, structure, place, where.arcLength);
  if (kind == EventKind::vesselBurned && isSealed(model, structure, vessels, where)) {
    log.emit(EventKind::vesselSealed, hand, structure, place, where.arcLength);
  } else if (openSides(cut) > 0.0) {
    log.emit(EventKind::cutOpen, hand, structure, place, openSides(cut));
  }
  if (kind == EventKind::vesselCut) {
    log.emit(EventKind::clipsTowardsStart, hand, structure, place, static_cast<double>(cut.before));
    log.emit(EventKind::clipsTowardsEnd, hand, structure, place, static_cast<double>(cut.after));
  }
  if (cut.throughClip) log.emit(EventKind::cutThroughClip, hand, structure, place, where.arcLength);
}

void reportTear(const Model& model, std::size_t tree, std::size_t element, State& state, StepLog& log) {
  const VesselTree& vesselTree = model.vesselTrees()[tree];
  const BeamModel& beams = vesselTree.beams;
  BeamState& vessels = state.vessel[tree];
  const BeamElement& torn = beams.elements()[element];
  const BeamModel::Branch& branch = beams.branches()[static_cast<std::size_t>(torn.branch)];
  BeamPoint where;
  where.branch = static_cast<std::size_t>(torn.branch);
  where.element = element;
  where.share = vessels.partedAt[element];
  where.arcLength = branch.arcLength[element - branch.firstElement] + where.share * torn.length;
  vessels.parting[element] = Parting::none;  // as it was before
  const CutSides cut = cutSides(beams, vessels, where);
  vessels.parting[element] = Parting::torn;
  if (openSides(cut) > 0.0) {
    log.emit(EventKind::cutOpen, StepLog::noHand, model.organs().size() + vesselTree.vessel[where.branch],
             vessels.position[static_cast<std::size_t>(torn.a)], openSides(cut));
  }
}

namespace {

constexpr double gripRoom = 0.0005;  ///< between blades and vessel where they count as touching (m). Assumed

}  // namespace

/// The vessel whose centre line runs between the jaws, nearest to the line in their middle.
/// @param length of that line, from the tips backwards (m)
std::optional<VesselTools::Crossing> VesselTools::vesselBetween(const State& state, std::size_t hand,
                                                                double length) const {
  std::optional<Crossing> best;
  const Pose tool = simulatedPose(state.hand[hand].instrument);
  const Vec3 along = tool.orientation * Vec3::UnitZ();
  const Quat toJaws = tool.orientation.conjugate();
  const InstrumentDefinition& instrument = instrumentOf(state.hand[hand].instrument.kind);
  double least = 1e300;
  for (std::size_t s = model_.organs().size(); s < model_.structures().size(); ++s) {
    const StructureModel& structure = model_.structures()[s];
    if (structure.kind != tissueId<VesselTissue>) continue;
    const BeamModel& beams = model_.vesselTrees()[structure.index].beams;
    const BeamState& now = state.vessel[structure.index];
    const BeamModel::Branch& branch = beams.branches()[structure.branch];
    // A vessel that is partly beyond the tips or behind the crotch counts with that part.
    const double beyond = pinchedSection(branch.section, 1.0).wide;
    const Vec3 crotch = tool.position - (length + beyond) * along;
    const Vec3 tips = tool.position + beyond * along;
    const JawSpace space = jawSpace(instrument, model_.scene().hands[hand].shaftRadius, length + beyond, beyond);
    for (std::size_t e = branch.firstElement; e < branch.firstElement + branch.elements(); ++e) {
      if (now.parting[e] != Parting::none) continue;
      const BeamElement& element = beams.elements()[e];
      const Vec3& a = now.position[static_cast<std::size_t>(element.a)];
      const Vec3& b = now.position[static_cast<std::size_t>(element.b)];
      const SegmentSegment close = closestSegments(crotch, tips, a, b);
      const double far = instrument.jawLength;
      if (!(close.squaredDistance < least) || close.squaredDistance > far * far) continue;
      // The part of the element between the jaws, nearest to their middle.
      const Vec3 from = toJaws * (a - tool.position);
      const Vec3 to = toJaws * (b - tool.position);
      const SmallPolygon part = between(space, from, to, to);
      if (part.count == 0) continue;
      const auto shareAt = [&](const Vec3& p) { return closestOnSegment(p, from, to); };
      double first = 1.0;
      double last = 0.0;
      for (std::size_t k = 0; k < part.count; ++k) {
        first = std::min(first, shareAt(part.corner[k]));
        last = std::max(last, shareAt(part.corner[k]));
      }
      const SegmentSegment inside = closestSegments(crotch, tips, a + first * (b - a), a + last * (b - a));
      if (!(inside.squaredDistance < least)) continue;
      least = inside.squaredDistance;
      best.emplace();
      best->structure = s;
      best->place.branch = structure.branch;
      best->place.element = e;
      best->place.share = first + inside.t * (last - first);
      const std::size_t i = e - branch.firstElement;
      best->place.arcLength = branch.arcLength[i] + best->place.share * (branch.arcLength[i + 1] - branch.arcLength[i]);
      best->depth = inside.s * (length + 2.0 * beyond) - beyond;
    }
  }
  if (!best) return best;
  const std::size_t tree = model_.structures()[best->structure].index;
  best->frame = centreLine(model_.vesselTrees()[tree].beams, state.vessel[tree], best->place);
  const double cosine = along.dot(best->frame.orientation * Vec3::UnitZ());
  best->sine = std::sqrt(notNegative(1.0 - cosine * cosine));
  return best;
}

/// Do both blades touch the vessel where it crosses them? It is then cut: blades that went on closing as blunt bodies
/// would only push it out.
bool VesselTools::isGripped(const State& state, std::size_t hand, const Crossing& crossing) {
  const StructureModel& structure = model_.structures()[crossing.structure];
  const BeamModel& beams = model_.vesselTrees()[structure.index].beams;
  const double outer = beams.branches()[structure.branch].section.outerRadius;
  instrument_.place(model_.scene().hands[hand], state.hand[hand].instrument);
  bool upper = false;
  bool lower = false;
  for (const Capsule& c : instrument_.capsule) {
    if (c.part != Capsule::Part::upperJaw && c.part != Capsule::Part::lowerJaw) continue;
    const Vec3& centre = crossing.frame.position;
    const Vec3 nearest = c.p0 + closestOnSegment(centre, c.p0, c.p1) * (c.p1 - c.p0);
    if ((nearest - centre).norm() > c.radius + outer + gripRoom) continue;
    (c.part == Capsule::Part::upperJaw ? upper : lower) = true;
  }
  return upper && lower;
}

void VesselTools::setClipOn(std::size_t hand, const std::optional<Crossing>& crossing, State& state, Activity& activity,
                            StepLog& log) const {
  InstrumentState& applier = state.hand[hand].instrument;
  if (applier.clips == 0) return;
  --applier.clips;
  const auto drop = [&] {
    log.emit(EventKind::clipDropped, hand, 0, applier.position, static_cast<double>(applier.clips));
  };
  if (!crossing) {
    drop();
    return;
  }
  const StructureModel& structure = model_.structures()[crossing->structure];
  const BeamModel& beams = model_.vesselTrees()[structure.index].beams;
  BeamState& vessels = state.vessel[structure.index];
  const ClipDescription& clip = model_.scene().clip;
  ClipAttempt attempt;
  attempt.point = crossing->place;
  attempt.width = clip.width;
  // An oblique vessel fills more of the legs.
  attempt.legs = clip.legs * crossing->sine;
  attempt.depth = crossing->depth * crossing->sine;
  const Vec3 closing = crossing->frame.orientation.conjugate() * (applier.orientation * Vec3::UnitY());
  attempt.roll = arctangent2(closing[1], closing[0]);
  const ClipSeat seat = clipSeat(beams, vessels, attempt);
  if (seat.missed) {
    drop();
    return;
  }
  setClip(beams, vessels, attempt, seat.enclosed);
  activity.disturb(structure.body);
  const auto report = [&](EventKind kind, double value) {
    log.emit(kind, hand, crossing->structure, crossing->frame.position, value);
  };
  report(EventKind::clipSet, seat.enclosed);
  report(EventKind::clipPlace, attempt.point.arcLength);
  if (seat.clip >= 0) report(EventKind::clipGap, seat.clipGap);
  if (seat.junctionGap < ClipSeat::none) report(EventKind::clipJunctionGap, seat.junctionGap);
  report(EventKind::clipEndGap, seat.endGap);
}

void VesselTools::closeOne(std::size_t hand, State& state, Activity& activity, StepLog& log) {
  HandState& h = state.hand[hand];
  const InstrumentDefinition& instrument = instrumentOf(h.instrument.kind);
  const bool clips = instrument.action == InstrumentAction::clip;
  if (!h.instrument.jawsOpened || (!clips && instrument.action != InstrumentAction::cut)) return;
  const bool closed = h.input.jaw <= instrument.jaw.closed || (clips && (h.input.buttons & button::fire) != 0);
  if (!closed && (clips || h.input.jaw > instrument.jaw.opened)) return;
  const std::optional<Crossing> crossing =
      vesselBetween(state, hand, clips ? model_.scene().clip.legs : instrument.bladeLength);
  if (clips) {
    setClipOn(hand, crossing, state, activity, log);
  } else if (crossing && isGripped(state, hand, *crossing)) {
    // Blades part what they enclose: the centre line must be between them.
    if (crossing->depth >= 0.0 && crossing->depth <= instrument.bladeLength) {
      partVessel(model_, crossing->structure, crossing->place, EventKind::vesselCut, hand, state, activity, log);
    }
  } else if (!closed) {
    return;
  }
  h.instrument.jawsOpened = false;
}

void VesselTools::run(State& state, Activity& activity, StepLog& log) {
  for (std::size_t hand = 0; hand < handCount; ++hand) closeOne(hand, state, activity, log);
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/tissue_damage.h"

#include <algorithm>

#include "sim/vessel/centre_line.h"
#include "sim/vessel/clips.h"

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
                Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log) {
  const StructureModel& s = model.structures()[structure];
  const VesselTree& tree = model.vesselTrees()[s.index];
  BeamState& vessels = state.vessel[s.index];
  const CutSides cut = cutSides(tree.beams, vessels, where);
  const Vec3 place = centreLine(tree.beams, vessels, where).position;
  if (!part(vessels, where, kind == EventKind::vesselCut ? Parting::cut : Parting::burned)) return;
  activity.disturb(bodies, state, s.body);
  surfaces.markBodyStale(s.body);
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

}  // namespace calot

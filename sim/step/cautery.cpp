// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/cautery.h"

#include <algorithm>

#include "sim/vessel/centre_line.h"

namespace calot {

namespace {

/// Energy of one touch after which its smoke is reported (J). Larger: fewer, later events. Assumed: half a second of 30
/// W.
constexpr double smokePortion = 15.0;

}  // namespace

/// Smoke is reported in portions of a touch, and when it ends. @param source structure, or noStructure: no touch
void CauteryEffects::emitSmoke(std::size_t hand, std::uint32_t source, double energy, Tissue& tissue) const {
  HandState& h = tissue.state.hand[hand];
  const auto emit = [&] {
    if (h.burnedEnergy > 0.0) tissue.log.emit(EventKind::smoke, hand, h.burning, h.simulatedPosition, h.burnedEnergy);
    h.burnedEnergy = 0.0;
  };
  if (source != h.burning) emit();
  h.burning = source;
  h.burnedEnergy += energy;
  if (h.burnedEnergy >= smokePortion) emit();
}

void CauteryEffects::burnVessel(std::size_t hand, std::size_t structure, const SurfaceContact& contact, double time,
                                Tissue& tissue) const {
  const StructureModel& s = model_.structures()[structure];
  const VesselTree& tree = model_.vesselTrees()[s.index];
  BeamState& vessels = tissue.state.vessel[s.index];
  double distance = 0.0;
  const BeamPoint where = closestPoint(tree.beams, vessels, s.branch, contact.onAxis, distance);
  if (vessels.parting[where.element] != Parting::none) return;
  vessels.exposure[where.element] += time;
  tissue.activity.disturb(tissue.bodies, tissue.state, s.body);
  if (vessels.exposure[where.element] >= model_.scene().vessels[tree.vessel[s.branch]].burnThrough) {
    partVessel(model_, structure, where, EventKind::vesselBurned, hand, tissue.bodies, tissue.surfaces, tissue.state,
               tissue.activity, tissue.log);
  }
}

void CauteryEffects::charOrgan(std::size_t structure, const SurfaceContact& contact, double time,
                               Tissue& tissue) const {
  const std::size_t o = model_.structures()[structure].index;
  const CauteryDescription& cautery = model_.scene().cautery;
  CharState& organ = tissue.state.charred[o];
  const std::vector<double>& area = model_.organs()[o].vertexArea;
  tissue.activity.charred[o] = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto vertex = static_cast<std::size_t>(contact.node[k]);
    if (!(area[vertex] > 0.0)) continue;
    const double before = organ.exposure[vertex];
    const double now = before + contact.weight[static_cast<int>(k)] * time * cautery.spot / area[vertex];
    organ.exposure[vertex] = static_cast<float>(now);
    organ.area += area[vertex] * (std::min(now / cautery.charTime, 1.0) - std::min(before / cautery.charTime, 1.0));
    const double through = model_.scene().organs[o].burnThrough;
    if (through > 0.0 && now >= through) {
      perforateOrgan(model_, o, tissue.surfaces.points(structure)[vertex], now, tissue.state, tissue.activity,
                     tissue.log);
    }
  }
}

/// Takes off the fat that the hook sweeps over. @return whether it touched any
bool CauteryEffects::carve(const std::vector<HookSweep>& sweeps, std::size_t hand, std::size_t fat, Tissue& tissue) {
  blades_.clear();
  const double more = model_.scene().cautery.carve;
  for (const HookSweep& sweep : sweeps) {
    blades_.push_back({sweep.before[0], sweep.before[1], sweep.now[0], sweep.now[1], sweep.radius + more});
  }
  const FatStroke done = tissue.bodies.fat(fat).stroke(tissue.state, blades_);
  if (!done.changed) return false;
  const std::size_t structure = tissue.bodies.structureOfFat(fat);
  tissue.activity.carved[fat] = true;
  tissue.surfaces.markStale(structure);
  tissue.activity.disturb(tissue.bodies, tissue.state, tissue.bodies.firstFat() + fat);
  tissue.result.fat[fat].carved += done.removed;
  tissue.result.fat[fat].islands += done.islands;
  if (done.islands > 0.0) tissue.log.emit(EventKind::fatCameLoose, hand, structure, done.where, done.islands);
  return done.nodes > 0;
}

void CauteryEffects::burnHand(const std::vector<HookSweep>& sweeps, std::uint32_t connective, std::size_t hand,
                              Tissue& tissue) {
  HandResult& out = tissue.result.hand[hand];
  out.cautery = Cautery::off;
  if (sweeps.empty()) {
    emitSmoke(hand, noStructure, 0.0, tissue);
    return;
  }
  const double reach = model_.scene().cautery.reach;
  std::uint32_t source = connective == noStructure ? noStructure : smokeOfConnective + connective;
  for (std::size_t f = 0; f < tissue.bodies.fatCount(); ++f) {
    if (carve(sweeps, hand, f, tissue) && source == noStructure) {
      source = static_cast<std::uint32_t>(tissue.bodies.structureOfFat(f));
    }
  }
  for (std::size_t s = 0; s < tissue.surfaces.size(); ++s) {
    // By parting a vessel or carving fat its skin has changed; what else this hook touches of it, it touches in the
    // next step.
    if (!tissue.surfaces.isCurrent(s)) continue;
    found_.clear();
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
      const HookSweep& sweep = sweeps[k];
      const std::span<const std::uint32_t> near =
          tissue.surfaces.patchesNear(s, sweep.now[0], sweep.now[1], capsuleSearch(sweep.radius, reach));
      capsuleContacts(tissue.surfaces.mesh(s), tissue.surfaces.points(s), near, sweep.now[0], sweep.now[1],
                      sweep.radius, reach, static_cast<std::uint32_t>(k), found_);
    }
    if (found_.empty()) continue;
    if (source == noStructure) source = static_cast<std::uint32_t>(s);
    const double share = 1.0 / static_cast<double>(found_.size());
    for (const SurfaceContact& contact : found_) {
      const TissueId kind = model_.structures()[s].kind;
      const double time = share * tissue.bodies.step();
      if (kind == tissueId<VesselTissue>) burnVessel(hand, s, contact, time, tissue);
      if (kind == tissueId<OrganTissue>) charOrgan(s, contact, time, tissue);
    }
  }
  out.cautery = source == noStructure ? Cautery::withoutContact : Cautery::onTissue;
  emitSmoke(hand, source, source == noStructure ? 0.0 : model_.scene().cautery.power * tissue.bodies.step(), tissue);
}

void CauteryEffects::run(const HookSweeps& sweeps, const std::array<std::uint32_t, handCount>& burned, Bodies& bodies,
                         Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log) {
  for (FatResult& fat : result.fat) fat.carved = fat.islands = 0.0;
  Tissue tissue{bodies, surfaces, state, activity, result, log};
  for (std::size_t h = 0; h < handCount; ++h) burnHand(sweeps[h], burned[h], h, tissue);
}

}  // namespace calot

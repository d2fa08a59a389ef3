// SPDX-License-Identifier: GPL-3.0-or-later
// What the energised hook does to skins: organs char, vessels burn through.
//
// Char is a count of how long each spot was under current. A touch gives its time to the corners of the triangle that
// it is on, by barycentric weights; a corner that stands for an area A of skin counts A / spot touches until it is
// charred as long as one spot would be. So the charred area grows by `spot` for each charTime of touch whatever the
// mesh, and can never shrink. Energy is power times time of touch.
#include <algorithm>
#include <cmath>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double smokeEvery = 15.0;  ///< J of one touch; so often smoke is told

}  // namespace

/// The hook's capsules on their way through this step, into `sweeps`; none where it carries no current.
void Stepper::Workspace::sweepHook(const State& state, std::size_t hand) {
  sweeps.clear();
  const HandState& h = state.hand[hand];
  const bool energised = (h.buttons & (button::cutPedal | button::coagulatePedal)) != 0;
  if (h.instrument != InstrumentKind::hook || !energised) return;
  const HandDescription& description = model.scene().hands[hand];
  const Pose now = simulated(state, hand);
  const InstrumentShape hook =
      instrumentShape(h.instrument, h.jaw, description.shaftRadius, (now.position - description.port).norm());
  const InstrumentShape before = placed(hook, poseBefore[hand]);
  const InstrumentShape after = placed(hook, now);
  for (std::size_t k = 0; k < after.capsules().size(); ++k) {
    const Capsule& from = before.capsules()[k];
    const Capsule& to = after.capsules()[k];
    if (to.part == Capsule::Part::hook) sweeps.push_back({{from.p0, from.p1}, {to.p0, to.p1}, to.radius});
  }
}

/// Smoke is told in portions of a touch, and when it ends. @param source structure, or noStructure: no touch
void Stepper::Workspace::tellSmoke(State& state, std::size_t hand, std::uint32_t source, double energy) {
  HandState& h = state.hand[hand];
  const auto tell = [&] {
    if (h.burnedEnergy > 0.0) {
      emit(EventKind::smoke, hand, static_cast<std::uint16_t>(h.burning), h.simulatedPosition, h.burnedEnergy);
    }
    h.burnedEnergy = 0.0;
  };
  if (source != h.burning) tell();
  h.burning = source;
  h.burnedEnergy += energy;
  if (h.burnedEnergy >= smokeEvery) tell();
}

/// Opens an organ that has a wall to be opened, once.
void Stepper::Workspace::perforate(State& state, std::size_t organ, const Vec3& where, double exposure) {
  if (!(model.scene().organs[organ].burnThrough > 0.0) || state.charred[organ].perforated) return;
  state.charred[organ].perforated = true;
  charred[organ] = true;
  emit(EventKind::organPerforated, 255, static_cast<std::uint16_t>(organ), where, exposure);
}

/// A touch of the hook on a skin. @param share of the step's time
void Stepper::Workspace::burnSkin(State& state, std::size_t hand, std::size_t structure, const SurfaceContact& contact,
                                  double share) {
  const StructureModel& s = model.structures()[structure];
  const CauteryDescription& cautery = model.scene().cautery;
  const double time = share * settings.step;
  if (s.kind == StructureKind::vessel) {
    const VesselTree& tree = model.vesselTrees()[s.index];
    BeamState& vessels = state.vessel[s.index];
    double distance = 0.0;
    const BeamPlace where = nearestPlace(tree.beams, vessels, s.branch, contact.onAxis, distance);
    if (vessels.parting[where.element] != Parting::none) return;
    vessels.exposure[where.element] += time;
    disturb(state, s.body);
    if (vessels.exposure[where.element] >= model.scene().vessels[tree.vessel[s.branch]].burnThrough) {
      partVessel(state, structure, where, Parting::burned, EventKind::vesselBurned, hand);
    }
    return;
  }
  if (s.kind == StructureKind::fat) return;
  CharState& organ = state.charred[s.index];
  const std::vector<double>& area = model.organs()[s.index].vertexArea;
  charred[s.index] = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto vertex = static_cast<std::size_t>(contact.node[k]);
    if (!(area[vertex] > 0.0)) continue;
    const double before = organ.exposure[vertex];
    const double now = before + contact.weight[static_cast<int>(k)] * time * cautery.spot / area[vertex];
    organ.exposure[vertex] = static_cast<float>(now);
    organ.area += area[vertex] * (std::min(now / cautery.charTime, 1.0) - std::min(before / cautery.charTime, 1.0));
    const double through = model.scene().organs[s.index].burnThrough;
    if (through > 0.0 && now >= through) perforate(state, s.index, skin[structure][vertex], now);
  }
}

/// Takes off the fat that the hook sweeps over. @return whether it touched any
bool Stepper::Workspace::carve(State& state, std::size_t hand, std::size_t fat) {
  blades.clear();
  const double more = model.scene().cautery.carve;
  for (const HookSweep& sweep : sweeps) {
    blades.push_back({sweep.before[0], sweep.before[1], sweep.now[0], sweep.now[1], sweep.radius + more});
  }
  const FatStroke done = fatMotion[fat]->stroke(state, blades);
  if (!done.changed) return false;
  const std::size_t structure = model.structures().size() - fatMotion.size() + fat;
  carved[fat] = true;
  bounded[structure] = false;
  disturb(state, firstFat() + fat);
  result.fat[fat].carved += done.removed;
  result.fat[fat].islands += done.islands;
  if (done.islands > 0.0)
    emit(EventKind::fatCameLoose, hand, static_cast<std::uint16_t>(structure), done.where, done.islands);
  return done.nodes > 0;
}

/// @pre bounds are those after the step; finishConnective() has counted what the hooks touched of strands
void Stepper::Workspace::burn(State& state) {
  for (FatResult& fat : result.fat) fat.carved = fat.islands = 0.0;
  for (std::size_t h = 0; h < handCount; ++h) {
    HandResult& out = result.hand[h];
    out.cautery = Cautery::off;
    sweepHook(state, h);
    if (sweeps.empty()) {
      tellSmoke(state, h, noStructure, 0.0);
      continue;
    }
    const double reach_ = model.scene().cautery.reach;
    std::uint32_t source = burnedTissue[h] == noStructure ? noStructure : smokeOfConnective + burnedTissue[h];
    for (std::size_t f = 0; f < fatMotion.size(); ++f) {
      if (carve(state, h, f) && source == noStructure) {
        source = static_cast<std::uint32_t>(model.structures().size() - fatMotion.size() + f);
      }
    }
    for (std::size_t s = 0; s < skinOf.size(); ++s) {
      // By parting a vessel or carving fat its skin has changed; what else this hook touches of it, it touches in the
      // next step.
      if (!bounded[s]) continue;
      found.clear();
      for (std::size_t k = 0; k < sweeps.size(); ++k) {
        const HookSweep& sweep = sweeps[k];
        const std::span<const std::uint32_t> near =
            patchesNear(s, sweep.now[0], sweep.now[1], capsuleSearch(sweep.radius, reach_));
        capsuleContacts(skinOf[s]->surface(), skin[s], near, sweep.now[0], sweep.now[1], sweep.radius, reach_,
                        static_cast<std::uint32_t>(k), found);
      }
      if (found.empty()) continue;
      if (source == noStructure) source = static_cast<std::uint32_t>(s);
      const double share = 1.0 / static_cast<double>(found.size());
      for (std::size_t k = 0; k < found.size(); ++k) burnSkin(state, h, s, SurfaceContact(found[k]), share);
    }
    out.cautery = source == noStructure ? Cautery::withoutContact : Cautery::onTissue;
    tellSmoke(state, h, source, source == noStructure ? 0.0 : model.scene().cautery.power * settings.step);
  }
}

}  // namespace calot

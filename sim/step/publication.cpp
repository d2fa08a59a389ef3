// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "sim/step/stages.h"

namespace calot {

namespace {

/// Share of the area of some strands that is attached; 0 of none.
double attachedShare(const ConnectiveTissue& tissue, const ConnectiveState& state,
                     std::span<const std::uint32_t> strands) {
  double all = 0.0;
  double attached = 0.0;
  for (const std::uint32_t s : strands) {
    const double area = tissue.strands()[s].area;
    all += area;
    if (state.condition[s] == StrandCondition::attached) attached += area;
  }
  return all > 0.0 ? attached / all : 0.0;
}

}  // namespace

Publication::Publication(const Model& model, const Bodies& bodies) : model_(model) {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    const FatBody& fat = bodies.fat(f).fat();
    std::vector<double>& whole = wholeRegion_.emplace_back();
    for (std::size_t r = 0; r < fat.model().regions(); ++r) whole.push_back(fat.volume().inRegion(r));
  }
}

/// Share that is left of the fat in a region.
double Publication::shareLeft(const Bodies& bodies, std::size_t fat, std::size_t region) const {
  const double whole = wholeRegion_[fat][region];
  return whole > 0.0 ? bodies.fat(fat).fat().volume().inRegion(region) / whole : 0.0;
}

void Publication::publishConnective(const State& state, StepResult& result) const {
  for (std::size_t c = 0; c < model_.connective().size(); ++c) {
    const ConnectiveModel& fixed = model_.connective()[c];
    ConnectiveResult& out = result.connective[c];
    out.lowerAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[0]);
    out.middleAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[1]);
    out.upperAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[2]);
  }
}

void Publication::publishOrgans(const State& state, StepResult& result) const {
  for (std::size_t o = 0; o < model_.organs().size(); ++o) {
    OrganResult& out = result.organ[o];
    out.maxDisplacement = state.organ[o].maxDisplacement;
    out.volume = state.organ[o].volume;
    out.charredArea = state.charred[o].area;
    out.wallExposure = state.charred[o].maxExposure;
  }
}

void Publication::publishVessel(const Bodies& bodies, bool awake, const State& state, std::size_t tree,
                                std::size_t branch, VesselResult& out) const {
  const VesselTree& vessels = model_.vesselTrees()[tree];
  const BeamState& beams = state.vessel[tree];
  const BeamModel::Branch& fixed = vessels.beams.branches()[branch];
  out.asleep = !awake;
  out.maxDisplacement = beams.maxDisplacement;
  out.maxStrain = 0.0;
  out.maxTension = 0.0;
  out.clips = 0;
  out.partings = 0;
  double exposure = 0.0;
  for (std::size_t e = fixed.firstElement; e < fixed.firstElement + fixed.elements(); ++e) {
    if (beams.parting[e] != Parting::none) ++out.partings;
    if (!awake) continue;
    out.maxStrain = std::max(out.maxStrain, bodies.vessel(tree).strain()[e]);
    out.maxTension = std::max(out.maxTension, bodies.vessel(tree).tension()[e]);
  }
  const double through = model_.scene().vessels[vessels.vessel[branch]].burnThrough;
  const double injured = model_.scene().cautery.injury * through;
  std::size_t stations = 0;
  for (std::size_t s = fixed.firstStation; s < fixed.firstStation + fixed.stations; ++s) {
    exposure = std::max(exposure, beams.exposure[s]);
    if (beams.exposure[s] >= injured) ++stations;
  }
  out.charred = exposure / through;
  out.injured = static_cast<double>(stations) * fixed.spacing();
  for (const std::uint32_t clipped : beams.clipBranch) out.clips += clipped == branch ? 1 : 0;
}

void Publication::publishVessels(const Bodies& bodies, const Activity& activity, const State& state,
                                 StepResult& result) const {
  for (std::size_t t = 0; t < model_.vesselTrees().size(); ++t) {
    const VesselTree& tree = model_.vesselTrees()[t];
    for (std::size_t branch = 0; branch < tree.vessel.size(); ++branch) {
      publishVessel(bodies, activity.awake[model_.organs().size() + t], state, t, branch,
                    result.vessel[tree.vessel[branch]]);
    }
  }
  for (const VesselCover& cover : model_.covers())
    result.vessel[cover.vessel].covered = shareLeft(bodies, cover.fat, cover.region);
}

void Publication::publishFat(const Bodies& bodies, const Activity& activity, const State& state,
                             StepResult& result) const {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    FatResult& out = result.fat[f];
    const FatBody& fat = bodies.fat(f).fat();
    out.asleep = !activity.awake[bodies.firstFat() + f];
    out.maxDisplacement = state.fat[f].solid.maxDisplacement;
    out.volume = fat.volume().total();
    const bool clears = model_.scene().fat[f].triangleDepth > 0.0;
    out.toClear = clears ? fat.volume().inRegion(FatTissue::regionToClear) : 0.0;
    out.uncleared = clears ? shareLeft(bodies, f, FatTissue::regionToClear) : 0.0;
  }
}

void Publication::publishHand(const HandState& hand, const Vec3& port, HandResult& out) {
  out.instrument = hand.instrument.kind;
  out.tipReal = hand.input.position;
  out.tipSimulated = hand.instrument.position;
  out.orientation = hand.instrument.orientation;
  out.jaw = hand.instrument.jaw;
  out.clips = hand.instrument.clips;
  out.insertion = (hand.instrument.position - port).norm();
}

void Publication::run(const Bodies& bodies, const Activity& activity, const State& state, StepResult& result) const {
  publishOrgans(state, result);
  publishConnective(state, result);
  publishVessels(bodies, activity, state, result);
  publishFat(bodies, activity, state, result);
  for (std::size_t h = 0; h < handCount; ++h) publishHand(state.hand[h], model_.scene().hands[h].port, result.hand[h]);
}

}  // namespace calot

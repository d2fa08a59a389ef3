// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/tissue_travel.h"

#include <algorithm>
#include <cmath>

namespace calot {

namespace {

constexpr double unseenMotion = 1e300;  ///< a motion of what was not seen before (m)

double largestSpeed(std::span<const Vec3> velocity) {
  double speed = 0.0;
  for (const Vec3& v : velocity) speed = std::max(speed, v.squaredNorm());
  return std::sqrt(speed);
}

}  // namespace

TissueTravel::TissueTravel(const Model& model) : model_(model) {
  for (std::size_t s = 0; s < model.structures().size(); ++s) {
    const StructureModel& structure = model.structures()[s];
    if (structure.kind != tissueId<VesselTissue>) continue;
    Vessel& vessel = vessel_.emplace_back();
    vessel.tree = structure.index;
    vessel.branch = structure.branch;
    vessel.structure = s;
    vessel.body = structure.body;
    const BeamModel& beams = model.vesselTrees()[vessel.tree].beams;
    vessel.radius = beams.branches()[vessel.branch].section.outerRadius;
    vesselCapsules(beams, restState(beams), vessel.branch, vessel.rest);
  }
  invalidate();
}

void TissueTravel::invalidate() {
  for (Vessel& v : vessel_) v.before.clear();
  organBefore_.assign(model_.organs().size(), {});
  organMotion_.assign(model_.organs().size(), 0.0);
  organSpeed_.assign(model_.organs().size(), 0.0);
  wasAwake_.assign(model_.bodies(), true);
}

void TissueTravel::follow(const Surfaces& surfaces, const Bodies& bodies, const State& state,
                          const std::vector<bool>& awake) {
  if (vessel_.empty() && model_.fat().empty()) return;  // nobody asks
  for (std::size_t o = 0; o < organBefore_.size(); ++o) {
    organMotion_[o] = 0.0;
    organSpeed_[o] = awake[o] ? largestSpeed(bodies[o].velocity(state)) : 0.0;
    const std::vector<Vec3>& now = surfaces.points(o);
    std::vector<Vec3>& before = organBefore_[o];
    if (!awake[o] && !wasAwake_[o] && before.size() == now.size()) continue;
    double moved = before.size() == now.size() ? 0.0 : unseenMotion;
    for (std::size_t i = 0; i < now.size() && moved < unseenMotion; ++i)
      moved = std::max(moved, (now[i] - before[i]).squaredNorm());
    organMotion_[o] = std::sqrt(moved);
    before = now;
  }
  for (Vessel& v : vessel_) {
    v.motion = 0.0;
    v.speed = awake[v.body] ? largestSpeed(bodies[v.body].velocity(state)) : 0.0;
    if (!awake[v.body] && !wasAwake_[v.body] && !v.before.empty()) continue;
    v.before.swap(v.now);
    vesselCapsules(model_.vesselTrees()[v.tree].beams, state.vessel[v.tree], v.branch, v.now);
    if (v.before.size() != v.now.size()) v.motion = unseenMotion;
    double moved = 0.0;
    for (std::size_t i = 0; i < v.now.size() && v.motion == 0.0; ++i) {
      moved =
          std::max({moved, (v.now[i].p0 - v.before[i].p0).squaredNorm(), (v.now[i].p1 - v.before[i].p1).squaredNorm()});
    }
    v.motion = std::max(v.motion, std::sqrt(moved));
    if (v.before.empty()) v.before = v.now;
  }
  wasAwake_ = awake;
}

}  // namespace calot

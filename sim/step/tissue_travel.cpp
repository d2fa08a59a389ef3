// SPDX-License-Identifier: GPL-3.0-or-later

#include "sim/step/tissue_travel.h"

#include <algorithm>
#include <cmath>

#include "sim/step/body.h"
#include "sim/vessel/centre_line.h"

namespace calot {

SolidSolver::Impulse VesselCapsule::place(double s) const {
  SolidSolver::Impulse out;
  addShare(out, node0, 1.0 - s);
  addShare(out, node1, s);
  return out;
}

void vesselCapsules(const BeamModel& beams, const BeamState& state, std::size_t branch,
                    std::vector<VesselCapsule>& out) {
  out.clear();
  const BeamModel::Branch& fixed = beams.branches()[branch];
  for (std::size_t i = 0; i < fixed.elements(); ++i) {
    const std::size_t e = fixed.firstElement + i;
    const BeamElement& element = beams.elements()[e];
    const Vec3& a = state.position[static_cast<std::size_t>(element.a)];
    const Vec3& b = state.position[static_cast<std::size_t>(element.b)];
    if (state.parting[e] == Parting::none) {
      out.push_back({a, b, element.a, element.b, i, false});
      continue;
    }
    const BeamPoint cut{branch, e, state.partedAt[e], 0.0};
    out.push_back({a, centreLine(beams, state, cut, Stump::before).position, element.a, element.a, i, false});
    out.push_back({centreLine(beams, state, cut, Stump::after).position, b, element.b, element.b, i, true});
  }
}

TreeDistances::TreeDistances(const BeamModel& beams) : nodes_(beams.nodes()), distance_(nodes_ * nodes_, 1e300) {
  // Nodes stand behind their parents, so each row takes what the rows before it have.
  for (std::size_t n = 0; n < nodes_; ++n) {
    distance_[n * nodes_ + n] = 0.0;
    if (beams.parents()[n] < 0) continue;
    const auto parent = static_cast<std::size_t>(beams.parents()[n]);
    const double length = beams.elements()[static_cast<std::size_t>(beams.elementBefore(n))].length;
    for (std::size_t m = 0; m < n; ++m) {
      distance_[n * nodes_ + m] = distance_[m * nodes_ + n] = distance_[parent * nodes_ + m] + length;
    }
  }
}

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
  if (vessel_.empty() && model_.fat().empty()) return;  // no other body needs it
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

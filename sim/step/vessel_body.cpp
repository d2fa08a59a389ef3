// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/vessel_body.h"

#include <algorithm>

namespace calot {

VesselBody::VesselBody(const Model& model, std::size_t tree, double step)
    : tree_(tree), beams_(model.vesselTrees()[tree].beams), step_(step) {}

std::span<const Vec3> VesselBody::position(const State& state) const { return state.vessel[tree_].position; }
std::span<const Vec3> VesselBody::velocity(const State& state) const { return state.vessel[tree_].velocity; }
std::uint32_t& VesselBody::quietSteps(State& state) const { return state.vessel[tree_].quietSteps; }

SolveReport VesselBody::solveUnconstrained(State& state, const Vec3& gravity, std::span<const Vec3> force,
                                           std::span<const TieLoad> ties) {
  attachment_.clear();
  for (const TieLoad& tie : ties) {
    attachment_.push_back({tie.place.node[0], tie.stiffness, tie.damping, tie.target, tie.velocity});
  }
  SolveReport report;
  report.converged = solver_.solveUnconstrained(beams_, state.vessel[tree_], {gravity, force, {}, attachment_}, step_);
  report.residual = report.converged ? 0.0 : 1.0;
  report.iterations = 1;
  return report;
}

Mat3 VesselBody::rotation(const State& /*state*/, int /*node*/) const { return Mat3::Identity(); }

bool VesselBody::advance(State& state) {
  report_ = solver_.advance(beams_, state.vessel[tree_]);
  return report_.finite;
}

void VesselBody::stop(State& state) const {
  BeamState& beams = state.vessel[tree_];
  std::fill(beams.velocity.begin(), beams.velocity.end(), Vec3::Zero());
  std::fill(beams.angularVelocity.begin(), beams.angularVelocity.end(), Vec3::Zero());
}

TubeSkin::TubeSkin(const Model& model, std::size_t tree, std::size_t branch)
    : beams_(model.vesselTrees()[tree].beams), tree_(tree), tube_(beams_, branch, tubeSettings) {}

bool TubeSkin::follow(const State& state) {
  const BeamState& beams = state.vessel[tree_];
  if (!tube_.update(beams) && contact_.has_value()) return false;
  BeamState rest = restState(beams_);
  rest.parting = beams.parting;
  rest.partedAt = beams.partedAt;
  std::vector<Vec3> vertex;
  tube_.positions(rest, vertex);
  contact_.emplace(vertex, tube_.triangles());
  return true;
}

void TubeSkin::place(const State& state, std::vector<Vec3>& out) const { tube_.positions(state.vessel[tree_], out); }

SolidSolver::Impulse TubeSkin::influence(const std::array<int, 3>& corner, const Vec3& weight) const {
  SolidSolver::Impulse out;
  for (std::size_t c = 0; c < 3; ++c) {
    const BeamInfluence& hung = tube_.influence(corner[c]);
    for (std::size_t k = 0; k < hung.count; ++k) {
      addShare(out, hung.node[k], weight[static_cast<int>(c)] * hung.weight[k]);
    }
  }
  return out;
}

}  // namespace calot

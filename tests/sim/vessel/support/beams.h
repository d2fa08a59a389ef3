// SPDX-License-Identifier: GPL-3.0-or-later
// Beams for tests: straight ones in units of their own, and vessels of life size.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/vessel/beam_solver.h"

namespace calot::test {

/// Along x from the origin, held at x = 0 when `held`: length 1, EI = 1, mass 1 a length, thin.
inline BeamBranch unitBeam(std::size_t elements, bool held, double slenderness = 1000.0) {
  BeamBranch branch;
  const double r = 1.0 / slenderness;
  for (std::size_t i = 0; i <= elements; ++i) {
    branch.node.emplace_back(static_cast<double>(i) / static_cast<double>(elements), 0.0, 0.0);
  }
  branch.section = {r, r};
  branch.material.young = 1.0 / branch.section.secondMoment();
  branch.material.poisson = 0.3;
  branch.material.density = 1.0 / branch.section.area();
  branch.fixedStart = held;
  return branch;
}

/// A cystic duct in size: 40 mm, 5 mm wide, wall 1 mm, bent in an arc, both ends held or not.
inline BeamBranch duct(std::size_t elements, bool heldStart, bool heldEnd) {
  BeamBranch branch;
  const std::vector<Vec3> points{{0.0, 0.0, 0.0}, {0.012, 0.006, 0.0}, {0.025, 0.006, 0.004}, {0.036, 0.0, 0.008}};
  branch.node = evenNodes(points, elements);
  branch.section = {0.0025, 0.001};
  branch.material = {3e5, 0.45, 1060.0, 5.0, 0.01, 0.6};
  branch.fixedStart = heldStart;
  branch.fixedEnd = heldEnd;
  return branch;
}

/// Steps until nothing moves. @returns the largest speed of the last step.
inline double settle(const BeamModel& model, BeamState& state, const BeamLoads& loads, double step, int steps,
                     double still = 1e-9) {
  BeamSolver solver;
  double speed = 1e300;
  for (int i = 0; i < steps && speed > still; ++i) {
    solver.solveUnconstrained(model, state, loads, step);
    speed = solver.advance(model, state).maxSpeed;
  }
  return speed;
}

inline bool isFinite(const BeamState& state) {
  for (std::size_t n = 0; n < state.position.size(); ++n) {
    if (!state.position[n].allFinite() || !state.velocity[n].allFinite() || !state.angularVelocity[n].allFinite() ||
        !(std::abs(state.orientation[n].norm() - 1.0) < 1e-12)) {
      return false;
    }
  }
  return true;
}

}  // namespace calot::test

// SPDX-License-Identifier: GPL-3.0-or-later
// Rest under loads that stay: steps until nothing moves.
#pragma once

#include <algorithm>

#include "sim/solid/solid.h"

namespace calot::test {

struct Settling {
  Vec3 gravity = Vec3::Zero();
  std::span<const Vec3> external = {};  ///< on the nodes (N), or empty
  Surroundings around = {};
  /// Steps far longer than the body swings take its mass out of account: each goes the whole way of the linear system
  /// with the rotations of its start.
  double step = 0.02;
  int most = 3000;      ///< steps
  double still = 1e-9;  ///< m/s
};

/// Steps with a solver that is all but exact, until every node is still. @returns the largest speed of the last step:
/// above `still` where it does not come to rest.
inline double settle(const SolidModel& model, SolidState& state, const Settling& how) {
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = how.step;
  settings.tolerance = 1e-6;
  settings.cap = 4000;
  double speed = 1e300;
  for (int i = 0; i < how.most && speed > how.still; ++i) {
    solver.solveUnconstrained(model, state, how.gravity, how.external, settings, executor, how.around);
    if (!solver.advance(model, state, {}, settings.step)) return 1e300;
    speed = 0.0;
    for (const Vec3& v : state.velocity) speed = std::max(speed, v.norm());
  }
  return speed;
}

}  // namespace calot::test

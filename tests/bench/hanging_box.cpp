// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/hanging_box.h"

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

/// A newton downwards, on the free face's nodes nearest to a place that goes to and fro across it in two seconds.
std::vector<Vec3> movingLoad(const test::KuhnBox& box, const BoxSize& size, int step) {
  std::vector<Vec3> load(box.node.size(), Vec3::Zero());
  const double phase = 0.02 * step - 2.0 * std::floor(0.01 * step);  // 0 to 2 s
  const double at = (phase < 1.0 ? phase : 2.0 - phase) * size.nz;
  for (int k = 0; k <= size.nz; ++k) {
    const double share = std::max(0.0, 1.0 - std::abs(k - at)) / (size.ny + 1);
    for (int j = 0; j <= size.ny; ++j)
      load[static_cast<std::size_t>(box.index(size.nx, j, k))] = Vec3(0.0, -share, 0.0);
  }
  return load;
}

}  // namespace

HangingBody hangingBox(const BoxSize& size, HangingBox kind) {
  const test::KuhnBox box =
      test::kuhnBox(size.nx, size.ny, size.nz, Vec3(0.0, -0.0375, -0.0375), Vec3(0.15, 0.0375, 0.0375));
  HangingBody body;
  body.node = box.node;
  body.tetrahedron = box.tetrahedron;
  body.fixed.assign(box.node.size(), false);
  const Vec3 cell(0.15 / size.nx, 0.075 / size.ny, 0.075 / size.nz);
  Random random(7);
  for (int k = 0; k <= size.nz; ++k) {
    for (int j = 0; j <= size.ny; ++j) {
      for (int i = 0; i <= size.nx; ++i) {
        const auto n = static_cast<std::size_t>(box.index(i, j, k));
        body.fixed[n] = i == 0;
        if (kind == HangingBox::framework || i == 0 || i == size.nx || j == 0 || j == size.ny || k == 0 || k == size.nz)
          continue;
        for (int a = 0; a < 3; ++a) body.node[n][a] += 0.15 * cell[a] * (2.0 * random.uniform() - 1.0);
      }
    }
  }
  body.gravity = [](int) { return Vec3(0.0, -9.81, 0.0); };
  if (kind == HangingBox::soft) body.load = [box, size](int step) { return movingLoad(box, size, step); };
  if (kind == HangingBox::stiff) body.youngModulus = 50e3;
  if (kind == HangingBox::framework) body.youngModulus = 10e3;
  return body;
}

Own hangOurs(const SolidModel& model, const HangingBody& body, int steps, double tolerance) {
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = body.step;
  settings.tolerance = tolerance;
  settings.cap = 4000;
  SolidState state = restState(model);
  {
    SolidState first = state;  // what a solver works out once
    solver.solveUnconstrained(model, first, body.gravity(0), {}, settings, executor);
  }
  Own own;
  for (int n = 0; n < steps; ++n) {
    const std::vector<Vec3> load = body.load ? body.load(n) : std::vector<Vec3>{};
    const double begin = threadSeconds();
    const SolveReport report = solver.solveUnconstrained(model, state, body.gravity(n), load, settings, executor);
    solver.advance(model, state, {}, settings.step);
    own.hung.seconds += (threadSeconds() - begin) / steps;
    own.iterations += static_cast<double>(report.iterations) / steps;
    own.converged = own.converged && report.converged;
  }
  own.hung.position = state.position;
  return own;
}

SolidModel modelOf(const HangingBody& body) {
  return {body.node,
          body.tetrahedron,
          body.fixed,
          {lameConstants(body.youngModulus, body.poissonRatio), body.density, 0.0, 0.0}};
}

}  // namespace calot::bench

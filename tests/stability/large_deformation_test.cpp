// SPDX-License-Identifier: GPL-3.0-or-later
// The solid alone, treated badly: torn nodes, absurd loads, any step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"

namespace calot {
namespace {

constexpr double cell = 0.01;  // m

SolidModel boxOnWall(bool held, double massDamping = 1.0, double stiffnessDamping = 0.02) {
  const test::KuhnBox box = test::kuhnBox(6, 4, 4, Vec3::Zero(), Vec3(6.0 * cell, 4.0 * cell, 4.0 * cell));
  std::vector<bool> fixed(box.node.size(), false);
  if (held) {
    for (int k = 0; k <= box.nz; ++k) {
      for (int j = 0; j <= box.ny; ++j) fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
    }
  }
  return {box.node, box.tetrahedron, fixed, {lameConstants(5e3, 0.45), 1060.0, massDamping, stiffnessDamping}};
}

bool isFinite(const SolidState& state) {
  for (const Vec3& p : state.position) {
    if (!p.allFinite()) return false;
  }
  for (const Vec3& v : state.velocity) {
    if (!v.allFinite()) return false;
  }
  for (const RotationGroup& group : state.rotation) {
    for (const auto& component : group) {
      for (const double q : component) {
        if (!std::isfinite(q)) return false;
      }
    }
  }
  return true;
}

int invertedElements(const SolidModel& model, const SolidState& state) {
  int inverted = 0;
  for (const Index4& t : model.tetrahedra()) {
    const auto at = [&](int c) -> const Vec3& { return state.position[static_cast<std::size_t>(t[c])]; };
    if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) <= 0.0) ++inverted;
  }
  return inverted;
}

double largestDisplacement(const SolidModel& model, const SolidState& state) {
  double largest = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n)
    largest = std::max(largest, (state.position[n] - model.rest()[n]).norm());
  return largest;
}

/// Kinetic and elastic energy (J). The elastic part from forces and rotations: V sigma : eps / 2 of an element is
/// -1/2 sum_a f_a . (x_a - R X_a).
double energy(const SolidModel& model, const SolidState& state) {
  std::vector<RotationGroup> rotation = state.rotation;
  std::vector<ElementResult> result(model.elements().groups().size());
  SerialExecutor executor;
  model.elements().evaluate(state.position, state.velocity, 0.0, model.material().lame, 8, rotation, result, executor);
  double sum = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) sum += 0.5 * model.mass()[n] * state.velocity[n].squaredNorm();
  for (std::size_t e = 0; e < model.tetrahedra().size(); ++e) {
    const std::size_t g = e / laneCount;
    const std::size_t l = e % laneCount;
    const Quat r(rotation[g][0][l], rotation[g][1][l], rotation[g][2][l], rotation[g][3][l]);
    for (std::size_t a = 0; a < 4; ++a) {
      const auto n = static_cast<std::size_t>(model.tetrahedra()[e][static_cast<int>(a)]);
      const Vec3 force(result[g].force[a][0][l], result[g].force[a][1][l], result[g].force[a][2][l]);
      sum -= 0.5 * force.dot(state.position[n] - r * model.rest()[n]);
    }
  }
  return sum;
}

TEST(LargeDeformation, ThrownNodesComeBack) {
  const SolidModel model = boxOnWall(true);
  SerialExecutor executor;
  SolidSolver::Settings settings;
  SCOPED_TRACE("seed 81");
  Random random(81);
  for (const double cells : {0.5, 1.0, 2.0, 4.0, 10.0}) {
    for (int trial = 0; trial < 3; ++trial) {
      SCOPED_TRACE(std::to_string(cells) + " cells, trial " + std::to_string(trial));
      SolidState state = restState(model);
      for (int k = 0; k < 6; ++k) {
        const auto n = static_cast<std::size_t>(
            model.freeNodes()[random.next() % static_cast<std::uint32_t>(model.freeNodes().size())]);
        const Vec3 direction(random.normal(), random.normal(), random.normal());
        state.position[n] += cells * cell * direction.normalized();
      }
      SolidSolver solver;
      for (int i = 0; i < 400; ++i) {
        solver.freeMotion(model, state, Vec3::Zero(), {}, settings, executor);
        ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
      }
      ASSERT_TRUE(isFinite(state));
      EXPECT_EQ(invertedElements(model, state), 0);
      EXPECT_LT(largestDisplacement(model, state), 0.01 * cell);
    }
  }
}

/// Every free node somewhere in a ball of five cells: nothing of the shape is left but the rest lengths.
TEST(LargeDeformation, AScrambledSolidStaysFinite) {
  const SolidModel model = boxOnWall(true);
  SerialExecutor executor;
  SolidSolver::Settings settings;
  SCOPED_TRACE("seed 82");
  Random random(82);
  for (int trial = 0; trial < 3; ++trial) {
    SolidState state = restState(model);
    for (const int free : model.freeNodes()) {
      state.position[static_cast<std::size_t>(free)] =
          5.0 * cell * Vec3(random.normal(), random.normal(), random.normal());
    }
    const double before = energy(model, state);
    SolidSolver solver;
    for (int i = 0; i < 300; ++i) {
      solver.freeMotion(model, state, Vec3::Zero(), {}, settings, executor);
      ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
    }
    ASSERT_TRUE(isFinite(state));
    EXPECT_LT(energy(model, state), 0.05 * before) << "trial " << trial;
    RecordProperty("inverted_after_scramble_" + std::to_string(trial), invertedElements(model, state));
  }
}

/// A thousand times its own weight, in every direction; let go, it comes back.
TEST(LargeDeformation, AThousandfoldLoadIsSurvived) {
  const SolidModel model = boxOnWall(true);
  SerialExecutor executor;
  SolidSolver::Settings settings;
  for (const Vec3& direction : {Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0), Vec3(0.0, -1.0, 0.3)}) {
    SolidState state = restState(model);
    SolidSolver solver;
    for (int i = 0; i < 600; ++i) {
      const Vec3 gravity = i < 100 ? Vec3(9810.0 * direction) : Vec3(Vec3::Zero());
      const SolveReport report = solver.freeMotion(model, state, gravity, {}, settings, executor);
      EXPECT_EQ(report.converged, report.residual <= settings.tolerance);
      ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
      ASSERT_TRUE(isFinite(state)) << "step " << i;
    }
    SCOPED_TRACE("direction " + std::to_string(direction[0]));
    EXPECT_LT(largestDisplacement(model, state), 0.05 * cell);
  }
}

/// Without damping of its own the scheme dissipates (implicit Euler), whatever the step. Two per cent of slack a step
/// for one linearisation a step, with rotations one step late. With steps of 0.1 s the box turns by more than ten
/// degrees a step, which one linearisation takes for stretch and gives back: there the start bounds every step.
TEST(LargeDeformation, EnergyDecaysWithAnyStep) {
  for (const double step : {0.001, 0.003, 0.01, 0.03, 0.1}) {
    SCOPED_TRACE("step " + std::to_string(step));
    const SolidModel model = boxOnWall(false, 0.0, 0.0);
    SolidState state = restState(model);
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      const Vec3& p = model.rest()[n];
      state.position[n] = Vec3(1.15 * p[0], 0.95 * p[1] + 0.1 * p[0], p[2]);
      state.velocity[n] = 0.2 * Vec3(p[1] - 2.0 * cell, -p[0], 0.5 * p[2]) / cell * 0.1;
    }
    SerialExecutor executor;
    SolidSolver::Settings settings;
    settings.step = step;
    SolidSolver solver;
    const double start = energy(model, state);
    double previous = start;
    for (int i = 0; i < 120; ++i) {
      solver.freeMotion(model, state, Vec3::Zero(), {}, settings, executor);
      ASSERT_TRUE(solver.advance(model, state, {}, step));
      const double now = energy(model, state);
      ASSERT_LE(now, step < 0.05 ? 1.02 * previous + 1e-9 * start : start) << "step number " << i;
      previous = now;
    }
    EXPECT_LT(previous, 0.9 * start);
    EXPECT_GE(previous, 0.0);
  }
}

}  // namespace
}  // namespace calot

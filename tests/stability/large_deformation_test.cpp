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
#include "tests/stability/support/solid_checks.h"

namespace calot {
namespace {

constexpr double cell = 0.01;  // m

SolidModel boxOnWall(bool held, double massDamping = 1.0, double stiffnessDamping = 0.02) {
  const test::KuhnBox box = test::kuhnBox(6, 4, 4, Vec3::Zero(), Vec3(6.0 * cell, 4.0 * cell, 4.0 * cell));
  const std::vector<bool> fixed = held ? box.firstFace() : std::vector<bool>(box.node.size(), false);
  return {box.node, box.tetrahedron, fixed, {lameConstants(5e3, 0.45), 1060.0, massDamping, stiffnessDamping}};
}

using test::energy;
using test::invertedElements;
using test::isFinite;
using test::maxDisplacement;

TEST(LargeDeformation, ThrownNodesComeBack) {
  const SolidModel model = boxOnWall(true);
  SerialExecutor executor;
  SolidSolver::Settings settings;
  SCOPED_TRACE("seed 81");
  Random random(81);
  for (const double cells : {0.5, 1.0, 2.0, 5.0, 10.0}) {
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
        solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor);
        ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
      }
      ASSERT_TRUE(isFinite(state));
      EXPECT_EQ(invertedElements(model, state), 0);
      EXPECT_LT(maxDisplacement(model, state), 0.01 * cell);
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
      solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor);
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
      const SolveReport report = solver.solveUnconstrained(model, state, gravity, {}, settings, executor);
      EXPECT_EQ(report.converged, report.residual <= settings.tolerance);
      ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
      ASSERT_TRUE(isFinite(state)) << "step " << i;
    }
    SCOPED_TRACE("direction " + std::to_string(direction[0]));
    EXPECT_LT(maxDisplacement(model, state), 0.05 * cell);
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
      solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor);
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

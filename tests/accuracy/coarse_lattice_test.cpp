// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients with a coarse lattice beside the sweeps.
#include "sim/solid/coarse_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/determinism/large_solid.h"
#include "tests/determinism/thread_executor.h"

namespace calot::coarse_lattice_test {
namespace {

constexpr double gravity = -9.81;

SolidModel boxModel(int nx, int ny, int nz, bool held = true) {
  test::KuhnBox box = test::kuhnBox(nx, ny, nz, Vec3(0.0, -0.0375, -0.0375), Vec3(0.15, 0.0375, 0.0375));
  std::vector<bool> fixed(box.node.size(), false);
  for (int k = 0; held && k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
  }
  return {std::move(box.node), std::move(box.tetrahedron), fixed, {lameConstants(5e3, 0.45), 1000.0, 0.0, 0.0}};
}

SolidSolver::Settings settingsOf(double tolerance, bool lattice) {
  SolidSolver::Settings settings;
  settings.step = 0.02;
  settings.tolerance = tolerance;
  settings.cap = 3000;
  settings.lattice = lattice;
  return settings;
}

struct Hung {
  SolidState state;
  double iterations = 0.0;
  bool converged = true;
};

Hung hang(const SolidModel& model, int steps, const SolidSolver::Settings& settings) {
  SerialExecutor executor;
  SolidSolver solver;
  Hung hung{restState(model)};
  for (int n = 0; n < steps; ++n) {
    const SolveReport report =
        solver.solveUnconstrained(model, hung.state, Vec3(0.0, gravity, 0.0), {}, settings, executor);
    solver.advance(model, hung.state, {}, settings.step);
    hung.iterations += static_cast<double>(report.iterations) / steps;
    hung.converged = hung.converged && report.converged;
  }
  return hung;
}

double differenceOf(const SolidModel& model, const SolidState& a, const SolidState& b) {
  double wrong = 0.0;
  double moved = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    wrong += (a.position[n] - b.position[n]).squaredNorm();
    moved += (b.position[n] - model.rest()[n]).squaredNorm();
  }
  return std::sqrt(wrong / moved);
}

TEST(CoarseLattice, OnlyLargeSolidsHaveOne) {
  EXPECT_FALSE(CoarseLattice::isWorthwhile(boxModel(10, 5, 5)));
  EXPECT_TRUE(CoarseLattice::isWorthwhile(boxModel(18, 10, 10)));
}

/// Both go to the same solution, and at their tolerances err alike.
TEST(CoarseLattice, SolvesWhatSweepsAloneSolve) {
  const SolidModel model = boxModel(18, 10, 10);
  constexpr int steps = 20;
  const Hung exact = hang(model, steps, settingsOf(1e-7, false));
  const Hung tight = hang(model, steps, settingsOf(1e-7, true));
  const Hung sweeps = hang(model, steps, settingsOf(1e-3, false));
  const Hung lattice = hang(model, steps, settingsOf(1e-3, true));
  EXPECT_LT(differenceOf(model, tight.state, exact.state), 2e-5);  // what single precision leaves
  const double errorOfSweeps = differenceOf(model, sweeps.state, exact.state);
  const double errorOfLattice = differenceOf(model, lattice.state, exact.state);
  EXPECT_LT(errorOfLattice, 1e-3);
  EXPECT_LT(errorOfLattice, 2.0 * errorOfSweeps);
  EXPECT_LT(lattice.iterations, 0.5 * sweeps.iterations);
  EXPECT_TRUE(sweeps.converged && lattice.converged);
}

/// A loose solve and one that goes on from it are together a tight one.
TEST(CoarseLattice, GoesOnFromWhatWasLeftOpen) {
  const SolidModel model = boxModel(18, 10, 10);
  SerialExecutor executor;
  const auto velocities = [&](double tolerance, bool goOn) {
    SolidSolver solver;
    SolidState state = restState(model);
    EXPECT_TRUE(
        solver.solveUnconstrained(model, state, Vec3(0.0, gravity, 0.0), {}, settingsOf(tolerance, true), executor)
            .converged);
    SolidSolver::Settings more = settingsOf(1e-5, true);
    more.goesOn = true;
    if (goOn) {
      EXPECT_TRUE(solver.applyImpulses({}, more).converged);
    }
    return solver.freeVelocity();
  };
  const auto differs = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double off = 0.0;
    double size = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      off += (a[n] - b[n]).squaredNorm();
      size += b[n].squaredNorm();
    }
    return std::sqrt(off / size);
  };
  const std::vector<Vec3> exact = velocities(1e-7, false);
  const double loose = differs(velocities(1e-2, false), exact);
  EXPECT_GT(loose, 1e-4);
  EXPECT_LT(differs(velocities(1e-2, true), exact), 0.01 * loose);
}

/// Nine times the elements: sweeps alone take twice the iterations.
TEST(CoarseLattice, IterationsDoNotGrowWithTheSolid) {
  const Hung small = hang(boxModel(18, 10, 10), 4, settingsOf(1e-3, true));
  const Hung large = hang(boxModel(38, 20, 20), 4, settingsOf(1e-3, true));
  EXPECT_LT(large.iterations, 1.3 * small.iterations);
}

/// A solid that nothing holds: no displacement of the lattice is stiff against moving as one, only heavy.
TEST(CoarseLattice, AFreeSolidFallsAsOne) {
  const SolidModel model = boxModel(18, 10, 10, false);
  constexpr int steps = 5;
  const Hung hung = hang(model, steps, settingsOf(1e-4, true));
  const double speed = gravity * 0.02 * steps;
  for (const Vec3& v : hung.state.velocity) EXPECT_LT((v - Vec3(0.0, speed, 0.0)).norm(), 1e-3 * std::abs(speed));
}

/// What is far from rest converges more slowly, as E is that of the shape at rest, but it converges.
TEST(CoarseLattice, ConvergesFarFromRest) {
  const SolidModel model = boxModel(18, 10, 10);
  SCOPED_TRACE("seed 17");
  Random random(17);
  SolidState state = restState(model);
  for (const int node : model.freeNodes()) {
    for (int a = 0; a < 3; ++a) state.position[static_cast<std::size_t>(node)][a] += 0.02 * (random.uniform() - 0.5);
  }
  SerialExecutor executor;
  SolidSolver solver;
  for (int n = 0; n < 40; ++n) {
    const SolveReport report =
        solver.solveUnconstrained(model, state, Vec3(0.0, gravity, 0.0), {}, settingsOf(1e-3, true), executor);
    EXPECT_TRUE(report.converged) << "step " << n;
    EXPECT_LT(report.iterations, 200U) << "step " << n;
    EXPECT_TRUE(solver.advance(model, state, {}, 0.02)) << "step " << n;
  }
  double low = 0.0;
  for (const Vec3& p : state.position) low = std::min(low, p[1]);
  EXPECT_GT(low, -0.3);  // of a box 0.15 m long
}

TEST(CoarseLattice, ThreadsChangeNoBit) {
  SerialExecutor serial;
  const std::vector<std::uint64_t> expected = test::largeSolid(serial);
  for (const unsigned threads : {2U, 3U, 4U}) {
    ThreadExecutor several(threads);
    EXPECT_EQ(test::largeSolid(several), expected) << threads << " threads";
  }
}

}  // namespace
}  // namespace calot::coarse_lattice_test

// SPDX-License-Identifier: GPL-3.0-or-later
// Contact forces of whole steps against a dense reference; residuals at the accuracy suite's own budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "tests/accuracy/support/dense_step.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// The accuracy suite's own budget.
SceneDescription tight(SceneDescription scene) {
  scene.solver.tolerance = 1e-7;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  scene.solver.iterations = 2000;
  scene.solver.responseTolerance = 1e-6;
  scene.solver.contactTolerance = 1e-10;
  scene.solver.gapTolerance = 0.0;
  scene.solver.contactIterations = 1000;
  scene.solver.contactPasses = 100;
  scene.solver.sleeping = false;
  scene.solver.dimples = false;  // of the mesh alone
  return scene;
}

double relativeResidual(const StepResult& result) {
  return result.contact.residual / std::max(result.contact.violation, 1e-4);
}

/// Presses, drags and lifts one instrument; in chosen steps the contact force is computed once more.
void compare(double friction, InstrumentKind instrument, double& worst, double& maxError, int& compared, int& slid) {
  SceneDescription scene = tight(test::blockScene(300, 10));
  scene.organs[0].friction = friction;
  scene.hands[0].instrument = instrument;
  scene.hands[0].couplingStiffness = 600.0;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 70; ++i) {
    const Vec3 tip(-0.008 + 2e-4 * std::max(0, i - 30), 1e-4 * std::max(0, i - 40),
                   test::blockTop + 0.004 - 3e-4 * std::min(i, 30));
    std::vector<TickSamples> ticks = test::ticksAt(scene, tip, scene.hands[1].home);
    for (TickSamples& tick : ticks) tick.hand[0].instrument = instrument;
    const SolidState before = rig.state.organ[0];
    const StepResult& result = rig.stepper.step(rig.state, ticks);
    EXPECT_EQ(result.misses & miss::contact, 0U);
    EXPECT_LE(relativeResidual(result), 1e-6) << "step " << i;
    const double error = result.contact.error / std::max(result.contact.violation, 1e-4);
    EXPECT_LE(error, 1e-6) << "step " << i << " after " << result.contact.passes << " passes";
    maxError = std::max(maxError, error);
    if (i % 4 != 3 || result.hand[0].contactForce.norm() < 0.05) continue;
    const Pose reference = rig.stepper.contactSet(0).reference;
    const Pose real{rig.state.hand[0].input.position, rig.state.hand[0].input.orientation};
    test::DenseContact dense = test::denseContact(*model, 0, before, reference, real, rig.state.hand[0].instrument.jaw,
                                                  0.0015, rig.stepper.contactSet(0));
    // Two pieces of a shape may touch the same place: the reference counts it once.
    std::vector<ToolRow> published;
    for (const ToolRow& row : rig.stepper.contactSet(0).direction) {
      const auto same = [&](const ToolRow& other) { return (row - other).norm() < 1e-12; };
      if (std::none_of(published.begin(), published.end(), same)) published.push_back(row);
    }
    ASSERT_EQ(dense.tool.size(), published.size()) << "every row is found again";
    Eigen::VectorXd lambda;
    if (friction == 0.0) {
      // Rows that stay open by far take no part; so few are left that every set of active ones can be tried.
      std::vector<int> near;
      for (int k = 0; k < dense.problem.free.size(); ++k) {
        if (dense.problem.free[k] < 5e-4) near.push_back(k);
      }
      ASSERT_LE(near.size(), 14U);
      const Eigen::MatrixXd w = dense.problem.w(near, near);
      const Eigen::VectorXd free = dense.problem.free(near);
      lambda = Eigen::VectorXd::Zero(dense.problem.free.size());
      const Eigen::VectorXd forces = test::byEnumeration(w, free, 1e-10);
      lambda(near) = forces;
    } else {
      ContactSolver solver;
      std::vector<double> forces = dense.problem.zeros();
      std::vector<double> gap = dense.problem.zeros();
      ASSERT_TRUE(solver.solve(dense.problem.view(), forces, gap, 1e-12, 20000).converged);
      EXPECT_LT(test::brokenLaws(dense.problem, forces), 1e-9);
      lambda = Eigen::Map<const Eigen::VectorXd>(forces.data(), static_cast<Eigen::Index>(forces.size()));
      slid += result.hand[0].contactForce.head<2>().norm() > 0.5 * friction * result.hand[0].contactForce[2] ? 1 : 0;
    }
    ToolRow expected = ToolRow::Zero();
    for (std::size_t k = 0; k < dense.tool.size(); ++k)
      expected += lambda[static_cast<Eigen::Index>(k)] * dense.tool[k];
    const double off = (result.hand[0].contactForce - expected.head<3>()).norm() / expected.head<3>().norm();
    EXPECT_LT(off, 0.01) << "step " << i << ": " << result.hand[0].contactForce.transpose() << " N, dense "
                         << expected.head<3>().transpose() << " N, rows " << result.contact.rows;
    EXPECT_NEAR(result.hand[0].contactTorque, expected[3],
                0.01 * 0.003 * expected.head<3>().norm() + 0.01 * std::abs(expected[3]));
    worst = std::max(worst, off);
    ++compared;
  }
}

TEST(DenseReference, ForcesWithoutFriction) {
  double worst = 0.0;
  double maxError = 0.0;
  int compared = 0;
  int slid = 0;
  for (const InstrumentKind kind : {InstrumentKind::grasper, InstrumentKind::hook}) {
    compare(0.0, kind, worst, maxError, compared, slid);
  }
  std::printf("%d steps without friction: forces within %.1e %% of the dense reference, relative residual %.1e\n",
              compared, 100.0 * worst, maxError);
  EXPECT_GE(compared, 16);
}

TEST(DenseReference, ForcesWithFriction) {
  double worst = 0.0;
  double maxError = 0.0;
  int compared = 0;
  int slid = 0;
  for (const double mu : {0.1, 0.4}) compare(mu, InstrumentKind::grasper, worst, maxError, compared, slid);
  std::printf(
      "%d steps with friction (%d pulled sideways): forces within %.1e %% of the dense reference, "
      "relative residual %.1e\n",
      compared, slid, 100.0 * worst, maxError);
  EXPECT_GE(compared, 16);
  EXPECT_GE(slid, 4);
}

/// An instrument dragged over a block: it sticks while the pull is inside the friction cone; then the force stays on
/// the cone, against the motion.
TEST(DenseReference, DraggedInstrumentsStickAndSlide) {
  for (const double mu : {0.15, 0.4}) {
    SceneDescription scene = tight(test::blockScene(700, 16));
    scene.organs[0].friction = mu;
    scene.organs[0].material.youngModulus = 40e3;  // firm: the face under the tip stays level
    scene.hands[0].instrument = InstrumentKind::hook;
    scene.hands[0].port = Vec3(-0.009, 0.0, 0.14);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    int sticking = 0;
    int sliding = 0;
    double worst = 0.0;
    for (int i = 0; i < 160; ++i) {
      const Vec3 tip(-0.009 + 1e-4 * std::max(0, i - 60), 0.0005, test::blockTop - 2.5e-4 * std::min(1.0, i / 30.0));
      std::vector<TickSamples> ticks = test::ticksAt(scene, tip, scene.hands[1].home);
      for (TickSamples& tick : ticks) tick.hand[0].instrument = InstrumentKind::hook;
      rig.stepper.step(rig.state, ticks);
      // Forces of each place, in its own frame: normal and along the face.
      const ContactSet& set = rig.stepper.contactSet(0);
      double normal = 0.0;
      double along = 0.0;
      Vec3 sideways = Vec3::Zero();
      for (std::size_t row = 0; row < set.lambda.size(); row += 3) {
        ASSERT_EQ(set.kind[row / 3], BlockKind::frictional);
        normal += set.lambda[row];
        const double tangent = std::hypot(set.lambda[row + 1], set.lambda[row + 2]);
        EXPECT_LE(tangent, mu * set.lambda[row] * (1.0 + 1e-6)) << "never outside the cone";
        along += tangent;
        for (std::size_t k = 1; k < 3; ++k) sideways += set.lambda[row + k] * set.direction[row + k].head<3>();
      }
      if (!(normal > 1e-3) || i < 60) continue;
      const double ratio = along / normal;
      if (ratio < 0.9 * mu) ++sticking;
      if (i > 130) {
        worst = std::max(worst, std::abs(ratio - mu) / mu);
        EXPECT_LT(sideways[0], -0.95 * sideways.norm()) << "against the motion, which is along x";
        ++sliding;
      }
    }
    std::printf("mu %.2f: sticks in %d steps; while sliding, force along / normal is mu within %.4f %%\n", mu, sticking,
                100.0 * worst);
    EXPECT_GT(sticking, 0);
    EXPECT_GT(sliding, 20);
    EXPECT_LT(worst, 0.01);
  }
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that break weak contact: a stiff tool on a thin sheet, starts from inverted organs, a heap of everything, and
// what ought to be symmetric.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/loop.h"
#include "tests/stability/support/depth.h"

namespace calot {
namespace {

/// A sheet of 40 x 40 x 3 mm, thinner than the tool and as soft as fat, held along two sides.
SceneDescription sheetScene() {
  SceneDescription scene = test::blockScene();
  scene.name = "sheet";
  OrganDescription sheet = scene.organs[0];
  sheet.name = "sheet";
  sheet.surface = test::boxSurface(Vec3(-0.02, -0.02, -0.0015), Vec3(0.02, 0.02, 0.0015), {20, 20, 2});
  sheet.tetrahedra = 4500;
  sheet.material.youngModulus = 2000.0;
  sheet.anchors = {{Vec3(-100.0 - 0.018, 0.0, 0.0), 100.0, "", 0.0}, {Vec3(100.0 + 0.018, 0.0, 0.0), 100.0, "", 0.0}};
  scene.organs = {sheet};
  return scene;
}

TEST(Bodies, AStiffToolDoesNotPassThroughAThinSheet) {
  SceneDescription scene = sheetScene();
  for (HandDescription& hand : scene.hands) hand.couplingStiffness = 3000.0;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  for (const double speed : {2.0, 0.2}) {
    test::Loop loop(*model);
    double deepest = 0.0;
    double pinched = 0.0;
    int touched = 0;
    const auto sample = [&](double t) {
      TickSamples tick = loop.resting();
      tick.hand[0].position = Vec3(-0.0013, 0.0017, std::max(0.05 - speed * t, -0.008));
      return tick;
    };
    const int steps = static_cast<int>(6.2 / speed) + 40;
    for (int step = 0; step < steps; ++step) {
      const StepResult& result = loop.step(sample, [] {});
      ASSERT_TRUE(test::allFinite(loop.rig.state));
      touched += result.hand[0].touching != 0 ? 1 : 0;
      const double depth = test::instrumentDepth(*model, loop.rig.state, 0);
      double& kept = result.contact.pinchedDepth > 0.0 ? pinched : deepest;
      kept = std::max(kept, depth);
      EXPECT_FALSE(test::shaftPierces(*model, loop.rig.state, 0, 0)) << "step " << step << " at " << speed << " m/s";
      if (testing::Test::HasFailure()) break;
    }
    std::printf("sheet at %.1f m/s: deepest %.3f mm, in pinches %.3f mm, touched in %d of %d steps, tip at %.1f mm\n",
                speed, 1e3 * deepest, 1e3 * pinched, touched, steps,
                1e3 * loop.rig.state.hand[0].instrument.position[2]);
    EXPECT_GT(touched, 10);
    EXPECT_LE(deepest, 2e-4);
  }
}

/// Organs that begin inside out or crushed, with an instrument on them: numbers stay finite, and the organ finds back.
TEST(Bodies, InvertedStartsRecover) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(300, 8));
  ASSERT_TRUE(model);
  const SolidModel& solid = model->organs()[0].solid;
  for (const int kind : {0, 1, 2}) {
    SCOPED_TRACE("kind " + std::to_string(kind) + ", seed 71");
    Random random(71);
    test::Rig rig(*model);
    SolidState& organ = rig.state.organ[0];
    for (const int node : solid.freeNodes()) {
      Vec3& p = organ.position[static_cast<std::size_t>(node)];
      if (kind == 0) p[2] = -0.02 - 0.5 * p[2];                // turned over through its own bottom
      if (kind == 1) p = Vec3(0.2 * p[0], 0.2 * p[1], -0.01);  // flat
      if (kind == 2) p += 0.004 * Vec3(random.normal(), random.normal(), random.normal());  // crumpled
    }
    organ.quietSteps = 0;
    rig.stepper.invalidate();
    for (int step = 0; step < 600; ++step) {
      const double down = step < 200 ? 0.0 : std::min(0.03, 5e-4 * (step - 200));
      const StepResult& result =
          rig.step(Vec3(-0.008, 0.001, (step < 200 ? test::blockTop - 0.002 : test::blockTop) + down));
      ASSERT_TRUE(test::allFinite(rig.state)) << "step " << step;
      ASSERT_TRUE(test::allFinite(result)) << "step " << step;
    }
    EXPECT_LT(rig.state.organ[0].maxDisplacement, 2e-3);
    EXPECT_NEAR(rig.state.organ[0].volume, restState(solid).volume, 0.02 * restState(solid).volume);
  }
}

/// Two loose plates, one on the other, fall on a third organ between two instruments that stir.
TEST(Bodies, EverythingTouchesEverything) {
  SceneDescription scene = test::blockScene(400, 8);
  scene.gravity = Vec3(0.0, 0.0, -9.81);
  for (const int storey : {0, 1}) {
    OrganDescription plate;
    plate.name = storey == 0 ? "lower plate" : "upper plate";
    plate.appearance = "gallbladder";
    const double half = storey == 0 ? 0.022 : 0.012;
    const Vec3 lower(-half + 0.002 * storey, -half - 0.001 * storey, test::blockTop + 0.0005 + 0.0125 * storey);
    plate.surface = test::boxSurface(lower, lower + Vec3(2.0 * half, 2.0 * half, 0.012), {8, 8, 4});
    plate.tetrahedra = 250;
    plate.material.youngModulus = 8000.0;
    plate.material.massDamping = 2.0;
    scene.organs.push_back(plate);
  }
  for (HandDescription& hand : scene.hands) hand.home[2] = 0.06;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Loop loop(*model);
  double deepest = 0.0;
  double pinched = 0.0;
  double tissue = 0.0;
  std::vector<double> residual;
  std::vector<double> error;
  std::uint32_t touchedOrgans = 0;
  int among = 0;
  const auto sample = [&](double t) {
    TickSamples tick = loop.resting();
    for (std::size_t h = 0; h < handCount; ++h) {
      const double side = h == 0 ? -1.0 : 1.0;
      const double down = std::min(1.0, t / 0.3);
      const double height = h == 0 ? 0.004 + 0.008 * std::sin(4.0 * t) : 0.020 + 0.008 * std::sin(3.0 * t);
      tick.hand[h].position = Vec3(side * ((h == 0 ? 0.0245 : 0.010) - 0.006 * std::sin(5.0 * t)),
                                   0.006 * std::cos(6.0 * t), 0.06 + down * (test::blockTop + height - 0.06));
      tick.hand[h].instrument = h == 0 ? InstrumentKind::grasper : InstrumentKind::hook;
      tick.hand[h].jaw = 0.4 + 0.4 * std::sin(8.0 * t);
    }
    return tick;
  };
  for (int step = 0; step < 250; ++step) {
    const StepResult& result = loop.step(sample, [&] {
      for (const HapticForce& force : loop.force) EXPECT_LE(force.force.norm(), 8.0 * (1.0 + 1e-12));
    });
    ASSERT_TRUE(test::allFinite(loop.rig.state)) << "step " << step;
    ASSERT_TRUE(test::allFinite(result)) << "step " << step;
    residual.push_back(result.contact.residual / std::max(result.contact.violation, 1e-4));
    error.push_back(result.contact.error / std::max(result.contact.violation, 1e-4));
    tissue = std::max(tissue, result.contact.tissueDepth);
    among += !loop.rig.state.tissue.key.empty() ? 1 : 0;
    for (std::size_t h = 0; h < handCount; ++h) {
      touchedOrgans |= result.hand[h].contacts();
      double& kept = result.contact.pinchedDepth > 0.0 ? pinched : deepest;
      kept = std::max(kept, test::instrumentDepth(*model, loop.rig.state, h));
    }
  }
  std::sort(residual.begin(), residual.end());
  std::sort(error.begin(), error.end());
  const double p99 = residual[residual.size() * 99 / 100];
  std::printf(
      "heap: instruments %.3f mm deep, in pinches %.3f mm, organs %.3f mm, relative residual p99 %.2e (posed "
      "anew %.2e), organs touched %x, steps with contact among organs %d\n",
      1e3 * deepest, 1e3 * pinched, 1e3 * tissue, p99, error[error.size() * 99 / 100], touchedOrgans, among);
  EXPECT_EQ(touchedOrgans, 7U) << "every organ is touched by an instrument";
  EXPECT_GT(among, 120);
  EXPECT_LE(deepest, 2e-4);
  EXPECT_LT(tissue, 3e-3);
  EXPECT_LE(p99, 1e-4);
}

/// A tip between two organs that press on it from both sides stays there: what is a tenth of a millimetre too deep is
/// no reason to leave the fold by centimetres.
TEST(Bodies, ATipInAFoldStaysThere) {
  SceneDescription scene = test::padOnBlockScene();
  scene.hands[0].port = Vec3(-0.12, 0.0, 0.09);
  scene.hands[0].home = Vec3(-0.04, 0.0, 0.03);
  for (HandDescription& hand : scene.hands) hand.instrument = InstrumentKind::hook;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  for (const double amplitude : {0.001, 0.003, 0.006}) {
    test::Loop loop(*model);
    const Vec3 before(-0.022, 0.0, test::blockTop + 0.5 * test::padGap);
    const auto sample = [&](double t) {
      TickSamples tick = loop.resting();
      const double arrive = std::min(1.0, t / 0.5);
      const double push = std::clamp((t - 0.5) / 1.0, 0.0, 1.0);
      tick.hand[0].position = (1.0 - arrive) * scene.hands[0].home + arrive * before + Vec3(0.015 * push, 0.0, 0.0) +
                              amplitude * push * Vec3(std::sin(13.0 * t), std::sin(7.0 * t), std::sin(10.0 * t));
      return tick;
    };
    double largest = 0.0;
    double deepest = 0.0;
    int pinches = 0;
    Vec3 last = loop.rig.state.hand[0].instrument.position;
    Vec3 lastReal = last;
    for (int step = 0; step < 500; ++step) {
      const StepResult& result = loop.step(sample, [] {});
      ASSERT_TRUE(test::allFinite(loop.rig.state)) << "step " << step;
      const Vec3& tip = result.hand[0].tipSimulated;
      if (step > 0) largest = std::max(largest, (tip - last).norm() - (result.hand[0].tipReal - lastReal).norm());
      last = tip;
      lastReal = result.hand[0].tipReal;
      pinches += result.contact.pinchedDepth > 0.0 ? 1 : 0;
      deepest = std::max(deepest, std::max(result.contact.maxDepth, result.contact.pinchedDepth));
    }
    std::printf("fold, %.0f mm: tip ahead of its hand by %.3f mm a step, %.3f mm deep, pinched in %d steps\n",
                1e3 * amplitude, 1e3 * largest, 1e3 * deepest, pinches);
    EXPECT_LT(largest, 0.003);
    EXPECT_LT(deepest, 1e-3);
    EXPECT_GT(pinches, 20) << "it must be pressed from both sides";
  }
}

/// Two instruments that squeeze a block from both sides, mirrored: forces are mirrored, and cancel along the squeeze.
TEST(Bodies, ASymmetricGraspStaysSymmetric) {
  SceneDescription scene = test::blockScene(900, 12);
  scene.organs[0].surface =
      test::boxSurface(Vec3(-0.012, -0.03, -test::blockTop), Vec3(0.012, 0.03, test::blockTop), {8, 20, 10});
  scene.hands[0].port = Vec3(-0.05, 0.0, 0.13);
  scene.hands[1].port = Vec3(0.05, 0.0, 0.13);
  scene.hands[0].home = Vec3(-0.03, 0.0, 0.03);
  scene.hands[1].home = Vec3(0.03, 0.0, 0.03);
  scene.solver.tolerance = 1e-6;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  scene.solver.responseTolerance = 1e-5;
  scene.solver.contactTolerance = 1e-10;
  scene.solver.gapTolerance = 0.0;
  scene.solver.contactIterations = 1000;
  scene.solver.iterations = 1000;
  for (HandDescription& hand : scene.hands) hand.instrument = InstrumentKind::hook;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Loop loop(*model);
  const auto sample = [&](double t) {
    TickSamples tick = loop.resting();
    const double in = std::min(1.0, t / 0.8);
    for (std::size_t h = 0; h < handCount; ++h) {
      const double side = h == 0 ? -1.0 : 1.0;
      tick.hand[h].position = Vec3(side * (0.022 - 0.013 * in), 0.0, 0.005);
      // The toe of the hook across y, mirrored: the x axis of the one is the other's turned about.
      tick.hand[h].orientation = Quat(Eigen::AngleAxisd(h == 0 ? 0.0 : 3.14159265358979323846, Vec3::UnitZ()));
    }
    return tick;
  };
  double worst = 0.0;
  Vec3 left = Vec3::Zero();
  Vec3 right = Vec3::Zero();
  for (int step = 0; step < 200; ++step) {
    const StepResult& result = loop.step(sample, [] {});
    left = result.hand[0].contactForce;
    right = result.hand[1].contactForce;
    if (left.norm() > 0.05) worst = std::max(worst, std::abs(left[0] + right[0]) / left.norm());
  }
  std::printf("squeeze: %.4f %.4f %.4f N and %.4f %.4f %.4f N, difference up to %.2f %%\n", left[0], left[1], left[2],
              right[0], right[1], right[2], 100.0 * worst);
  ASSERT_GT(left.norm(), 0.05);
  EXPECT_LT(left[0], 0.0);
  EXPECT_GT(right[0], 0.0);
  EXPECT_LT(std::abs(left[0] + right[0]), 0.02 * left.norm()) << "what one side feels, the other does";
  EXPECT_LT(std::abs(left[2] - right[2]), 0.05 * left.norm()) << "friction and the mesh's own diagonals apart";
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Two organs of which one is ten thousand times as stiff as the other, in contact and grown together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "tests/sim/scene/support/loop.h"

namespace calot {
namespace {

constexpr double soft = 3000.0;  // Pa
constexpr double stiff = 1e4 * soft;

/// A block held at its bottom, and a plate above it.
SceneDescription plateOverBlock(double block, double plate, double gap) {
  SceneDescription scene = test::blockScene(300, 6);
  scene.organs[0].material.youngModulus = block;
  OrganDescription over;
  over.name = "plate";
  over.appearance = "gallbladder";
  const Vec3 lower(-0.020, -0.020, test::blockTop + gap);
  over.surface = test::boxSurface(lower, lower + Vec3(0.04, 0.04, 0.012), {8, 8, 4});
  over.tetrahedra = 250;
  over.material.youngModulus = plate;
  over.material.massDamping = 2.0;
  // Held along one side: organs slide on each other without friction.
  over.anchors.push_back({Vec3(-100.0 - 0.0165, 0.0, 0.0), 100.0, "", 0.0});
  scene.organs.push_back(over);
  for (HandDescription& hand : scene.hands) hand.home[2] = 0.08;
  return scene;
}

/// What a run met with.
struct Course {
  int solverMisses = 0, contactMisses = 0, speedMisses = 0;
  double lastSpeed = 0.0;  ///< of any organ (m/s)
  double deepest = 0.0;    ///< overlap of the organs, beyond that at rest (m)
  double touched = 0.0;    ///< share of steps with contact among organs
};

/// 300 steps: the left hand presses down on the plate for a second and leaves; then 200 steps on their own.
Course press(const Model& model, test::Loop& loop, double top) {
  Course run;
  constexpr int steps = 500;
  const auto sample = [&](double t) {
    TickSamples tick = loop.resting();
    const double down = t < 1.0 ? 0.0 : (t < 2.0 ? t - 1.0 : std::max(0.0, 3.0 - t));
    tick.hand[0].position = Vec3(-0.006, 0.004, 0.08 + down * (top - 0.004 - 0.08));
    return tick;
  };
  for (int i = 0; i < steps; ++i) {
    const StepResult& result = loop.step(sample, [] {});
    EXPECT_TRUE(test::allFinite(loop.rig.state)) << "step " << i;
    EXPECT_EQ(result.misses & miss::runaway, 0U) << "step " << i;
    // A step that missed says so: the residual above the tolerance and the bit stand together.
    double residual = 0.0;
    for (const OrganResult& organ : result.organ) residual = std::max(residual, organ.residual);
    if (residual > model.scene().solver.tolerance) {
      EXPECT_NE(result.misses & miss::solver, 0U) << "step " << i;
    }
    run.solverMisses += (result.misses & miss::solver) != 0 ? 1 : 0;
    run.contactMisses += (result.misses & miss::contact) != 0 ? 1 : 0;
    run.speedMisses += (result.misses & miss::speed) != 0 ? 1 : 0;
    run.lastSpeed = 0.0;
    for (const OrganResult& organ : result.organ) run.lastSpeed = std::max(run.lastSpeed, organ.maxSpeed);
    if (i > 100) run.deepest = std::max(run.deepest, result.contact.tissueDepth);
    run.touched += loop.rig.state.tissue.key.empty() ? 0.0 : 1.0 / steps;
    if (testing::Test::HasFailure()) break;
  }
  return run;
}

void print(const char* what, const Course& run) {
  std::printf(
      "%s: missed by solver %d, contact %d, speed %d of 500 steps; overlap %.3f mm, touching in %.0f %%, at last "
      "%.1e m/s\n",
      what, run.solverMisses, run.contactMisses, run.speedMisses, 1e3 * run.deepest, 100.0 * run.touched,
      run.lastSpeed);
}

TEST(StiffnessContrast, InContact) {
  for (const bool softBelow : {true, false}) {
    SceneDescription scene = plateOverBlock(softBelow ? soft : stiff, softBelow ? stiff : soft, 0.0005);
    scene.gravity = Vec3(0.0, 0.0, -9.81);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Loop loop(*model);
    const Course course = press(*model, loop, test::blockTop + 0.012);
    print(softBelow ? "stiff plate on soft block" : "soft plate on stiff block", course);
    EXPECT_GT(course.touched, 0.9);
    EXPECT_LT(course.deepest, softBelow ? 1.2e-3 : 0.7e-3);
    EXPECT_LT(course.lastSpeed, 0.05) << "what lies on another organ without friction goes on trembling, and no more";
    EXPECT_EQ(course.solverMisses + course.contactMisses + course.speedMisses, 0);
  }
}

TEST(StiffnessContrast, GrownTogether) {
  for (const bool softBelow : {true, false}) {
    SceneDescription scene = plateOverBlock(softBelow ? soft : stiff, softBelow ? stiff : soft, 0.001);
    ConnectiveDescription bed;
    bed.name = "bed";
    bed.first = "plate";
    bed.second = "block";
    bed.strength = 1e6;
    bed.fractureEnergy = 1e7;
    scene.connective.push_back(bed);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Loop loop(*model);
    const Course course = press(*model, loop, test::blockTop + 0.013);
    print(softBelow ? "stiff plate grown to soft block" : "soft plate grown to stiff block", course);
    EXPECT_LT(course.lastSpeed, 5e-4);
    EXPECT_EQ(course.solverMisses + course.contactMisses + course.speedMisses, 0);
    for (const SolidState& organ : loop.rig.state.organ) EXPECT_LT(organ.maxDisplacement, 1e-3);
  }
}

}  // namespace
}  // namespace calot

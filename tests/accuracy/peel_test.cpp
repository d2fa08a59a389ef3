// SPDX-License-Identifier: GPL-3.0-or-later
// A pad peeled off a block that it is grown to, by springs of a hand on one end: how much has torn depends neither on
// the step nor on the mesh.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double seconds = 2.5;

/// A pad of 40 x 20 x 10 mm, 2 mm above the block, lifted by 45 mm at one end and bent over.
SceneDescription peeledPad(double mesh, std::uint32_t ticksPerStep) {
  SceneDescription scene = test::blockScene(static_cast<std::uint32_t>(800.0 * mesh));
  scene.name = "pad peeled off a block";
  scene.ticksPerStep = ticksPerStep;
  scene.organs[0].material.youngModulus = 20e3;
  OrganDescription pad;
  pad.name = "pad";
  pad.appearance = "gallbladder";
  pad.surface = test::boxSurface(Vec3(-0.02, -0.01, test::blockTop + 0.002), Vec3(0.02, 0.01, test::blockTop + 0.012),
                                 {12, 6, 3});
  pad.tetrahedra = static_cast<std::uint32_t>(800.0 * mesh);
  pad.material = {20e3, 0.45, 1020.0, 2.0, 0.01};
  scene.organs.push_back(pad);
  ConnectiveDescription bed;
  bed.name = "bed";
  bed.first = "pad";
  bed.second = "block";
  bed.reach = 0.003;
  bed.strands = 1500;
  scene.connective = {bed};
  RetractionDescription hand;
  hand.organ = "pad";
  hand.centre = Vec3(-100.0 - 0.012, 0.0, test::blockTop);
  hand.radius = 100.0;  // as good as a plane: the last 8 mm
  hand.displacement = Vec3(0.015, 0.0, 0.045);
  hand.duration = 2.0;
  hand.stiffness = 1000.0;
  hand.damping = 1.0;
  scene.retraction.push_back(hand);
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  return scene;
}

double tornShare(double mesh, std::uint32_t ticksPerStep) {
  const SceneDescription scene = peeledPad(mesh, ticksPerStep);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  if (!model) return -1.0;
  test::Rig rig(*model);
  double torn = 0.0;
  std::uint32_t iterations = 0;
  for (std::uint32_t ms = 0; ms < static_cast<std::uint32_t>(1000.0 * seconds); ms += ticksPerStep) {
    const StepResult& result = rig.step(scene.hands[0].home, scene.hands[1].home);
    EXPECT_EQ(result.misses, 0U) << ms << " ms";
    torn = result.connective[0].torn;
    iterations = std::max(iterations, result.organ[0].iterations);
  }
  std::printf("%zu and %zu tetrahedra, %u ms: torn %.4f, at most %u iterations\n",
              model->organs()[0].solid.tetrahedra().size(), model->organs()[1].solid.tetrahedra().size(), ticksPerStep,
              torn, iterations);
  return torn;
}

TEST(Peel, TornShareDependsNeitherOnStepNorOnMesh) {
  const double finest = tornShare(4.0, 2);
  EXPECT_GT(finest, 0.2);
  EXPECT_LT(finest, 0.8);
  for (const std::uint32_t ticks : {2U, 5U, 10U, 20U}) {
    EXPECT_NEAR(tornShare(1.0, ticks) / finest, 1.0, 0.05) << ticks << " ms";
    if (ticks == 2U) continue;
    EXPECT_NEAR(tornShare(4.0, ticks) / finest, 1.0, 0.05) << ticks << " ms";
  }
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Organs that rest on, slide along and press against one another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double gravity = 9.81;

/// A slab that is held at its bottom and a cube that nothing holds, a hair above it. Instruments are far away.
SceneDescription slabAndCube() {
  SceneDescription scene;
  scene.name = "slab and cube";
  scene.workspace = {Vec3(-0.25, -0.25, -0.25), Vec3(0.25, 0.25, 0.25)};
  OrganDescription slab;
  slab.name = "slab";
  slab.appearance = "liver";
  slab.surface = test::boxSurface(Vec3(-0.06, -0.03, -0.02), Vec3(0.06, 0.03, 0.0), {24, 12, 4});
  slab.tetrahedra = 800;
  slab.material.youngModulus = 20e3;
  slab.material.massDamping = 1.0;
  slab.anchors.push_back({Vec3(0.0, 0.0, -100.0 - 0.012), 100.0, "", 0.0});
  OrganDescription cube;
  cube.name = "cube";
  cube.appearance = "liver";
  cube.surface = test::boxSurface(Vec3(-0.045, -0.01, 2e-5), Vec3(-0.025, 0.01, 0.02002), {8, 8, 8});
  cube.tetrahedra = 250;
  cube.material.youngModulus = 20e3;
  scene.organs = {slab, cube};
  scene.solver.sleeping = false;
  for (std::size_t h = 0; h < handCount; ++h) {
    scene.hands[h].port = Vec3(h == 0 ? -0.02 : 0.02, 0.1, 0.2);
    scene.hands[h].home = Vec3(h == 0 ? -0.02 : 0.02, 0.1, 0.15);
  }
  return scene;
}

double massOf(const Model& model, std::size_t organ) {
  const std::vector<double>& mass = model.organs()[organ].solid.mass();
  return std::accumulate(mass.begin(), mass.end(), 0.0);
}

Vec3 meanVelocity(const Model& model, const State& state, std::size_t organ) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 0; n < state.organ[organ].velocity.size(); ++n) {
    sum += model.organs()[organ].solid.mass()[n] * state.organ[organ].velocity[n];
  }
  return sum / massOf(model, organ);
}

/// Two bodies in a stack: the forces between them carry the upper one's weight.
TEST(TissueContact, AStackCarriesItsWeight) {
  SceneDescription scene = slabAndCube();
  scene.gravity = Vec3(0.0, 0.0, -gravity);
  scene.organs[1].material.massDamping = 5.0;
  for (Vec3& p : scene.organs[1].surface.vertex) p[0] += 0.035;  // in the middle, where its own dent holds it
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  double deepest = 0.0;
  std::vector<double> residual;
  for (int i = 0; i < 250; ++i) {
    const StepResult& result = rig.step(scene.hands[0].home);
    EXPECT_EQ(result.misses & miss::solver, 0U) << "step " << i;
    residual.push_back(result.contact.residual / std::max(result.contact.violation, 1e-4));
    if (i > 20) deepest = std::max(deepest, result.contact.tissueDepth);
  }
  const double weight = massOf(*model, 1) * gravity;
  std::sort(residual.begin(), residual.end());
  EXPECT_LT(residual[242], 1e-3);
  // Over two seconds: it wanders, and what it is accelerated by in a shorter time is a hundredth of its weight.
  constexpr int steps = 200;
  double mean = 0.0;
  for (int i = 0; i < steps; ++i) {
    const StepResult& result = rig.step(scene.hands[0].home);
    mean += std::accumulate(rig.state.tissue.force.begin(), rig.state.tissue.force.end(), 0.0) / steps;
    deepest = std::max(deepest, result.contact.tissueDepth);
  }
  std::printf(
      "stack: contact %.5f N, weight %.5f N, deepest overlap %.4f mm, speed %.2e m/s, "
      "relative residual p97 %.1e\n",
      mean, weight, 1e3 * deepest, meanVelocity(*model, rig.state, 1).norm(), residual[242]);
  EXPECT_NEAR(mean, weight, 0.01 * weight);
  // Without friction it wanders about in its dent, whose ground has facets: 0.2 to 4 mm/s, whatever the tolerances.
  EXPECT_LT(meanVelocity(*model, rig.state, 1).norm(), 8e-3);
  EXPECT_LT(deepest, 2e-4);
}

/// Wet tissue slides without friction: on a slope of any angle with g sin(angle), pressed by its weight's other part.
/// Both are firm: sharp edges of a body that sinks in would plough.
TEST(TissueContact, ABlockSlidesDownASlope) {
  for (const double angle : {0.3, 0.5}) {
    SceneDescription scene = slabAndCube();
    for (OrganDescription& organ : scene.organs) organ.material.youngModulus = 500e3;
    scene.gravity = gravity * Vec3(std::sin(angle), 0.0, -std::cos(angle));
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    std::vector<double> speed;
    double lift = 0.0;  // mean over the run: firm bodies tremble on one another
    for (int i = 0; i < 20; ++i) {
      rig.step(scene.hands[0].home);
      lift += meanVelocity(*model, rig.state, 1)[2] / 20.0;
      speed.push_back(meanVelocity(*model, rig.state, 1)[0]);
    }
    const double acceleration = (speed[19] - speed[0]) / 0.19;
    std::printf("slope %.1f rad: %.4f m/s^2, g sin %.4f\n", angle, acceleration, gravity * std::sin(angle));
    EXPECT_NEAR(acceleration, gravity * std::sin(angle), 0.03 * gravity * std::sin(angle));
    EXPECT_LT(std::abs(lift), 0.02);
  }
}

/// Pressing the cube into the slab with an instrument: what goes in at the top comes out below.
TEST(TissueContact, APushGoesThroughToTheOrganBelow) {
  SceneDescription scene = slabAndCube();
  for (Vec3& p : scene.organs[1].surface.vertex) p[0] += 0.035;  // under the port
  scene.organs[1].anchors.clear();
  scene.hands[0].port = Vec3(0.0, 0.0, 0.2);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.06);
  scene.organs[1].material.massDamping = 20.0;
  scene.organs[0].friction = scene.organs[1].friction = 0.5;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  double below = 0.0;
  double above = 0.0;
  for (int i = 0; i < 200; ++i) {
    const StepResult& result = rig.step(Vec3(0.0003, 0.0002, 0.03 - 0.012 * std::min(1.0, i / 100.0)));
    ASSERT_TRUE(test::allFinite(rig.state));
    if (i < 150) continue;
    above += result.hand[0].contactForce[2] / 50.0;
    below += std::accumulate(rig.state.tissue.force.begin(), rig.state.tissue.force.end(), 0.0) / 50.0;
    EXPECT_LT(result.contact.tissueDepth, 4e-4);
  }
  std::printf("push: %.4f N in, %.4f N through\n", above, below);
  EXPECT_GT(above, 0.05);
  EXPECT_NEAR(below, above, 0.03 * above);
}

std::size_t insideOut(const SolidModel& solid, const SolidState& state) {
  return static_cast<std::size_t>(
      std::count_if(solid.tetrahedra().begin(), solid.tetrahedra().end(), [&](const Index4& t) {
        const auto at = [&](int k) -> const Vec3& { return state.position[static_cast<std::size_t>(t[k])]; };
        return !((at(1) - at(0)).dot((at(2) - at(0)).cross(at(3) - at(0))) > 0.0);
      }));
}

/// A soft bag that is crumpled until much of it is inside out finds back, though it meets itself all over: where a
/// skin's outward is inward, contact would hold it so.
TEST(TissueContact, WhatIsInsideOutTurnsBack) {
  SceneDescription scene = slabAndCube();
  OrganDescription& bag = scene.organs[1];
  bag.surface = test::boxSurface(Vec3(-0.05, -0.012, 0.001), Vec3(0.02, 0.012, 0.025), {20, 8, 8});
  bag.tetrahedra = 300;
  bag.material.youngModulus = 3e3;
  bag.material.massDamping = 5.0;
  bag.anchors.push_back({Vec3(-100.0 - 0.045, 0.0, 0.0), 100.0, "", 0.0});
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  const SolidModel& solid = model->organs()[1].solid;
  for (const std::uint64_t seed : {81U, 82U, 83U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    test::Rig rig(*model);
    SolidState& organ = rig.state.organ[1];
    for (const int node : solid.freeNodes()) {
      Vec3& p = organ.position[static_cast<std::size_t>(node)];
      for (int a = 0; a < 3; ++a) p[a] += 0.008 * random.normal();
    }
    organ.quietSteps = 0;
    rig.stepper.invalidate();
    const std::size_t before = insideOut(solid, organ);
    double fastest = 0.0;
    std::uint32_t rows = 0;
    for (int step = 0; step < 400; ++step) {
      const StepResult& result = rig.step(scene.hands[0].home);
      ASSERT_TRUE(test::allFinite(rig.state)) << "step " << step;
      if (step > 50) fastest = std::max(fastest, result.organ[1].maxSpeed);
      rows = std::max(rows, result.contact.rows);
    }
    std::printf("bag, seed %d: inside out %zu of %zu, then %zu; displaced by %.2f mm; %.2f m/s, %u rows at most\n",
                static_cast<int>(seed), before, solid.tetrahedra().size(), insideOut(solid, rig.state.organ[1]),
                1e3 * rig.state.organ[1].maxDisplacement, fastest, rows);
    EXPECT_GT(before, solid.tetrahedra().size() / 10);
    EXPECT_EQ(insideOut(solid, rig.state.organ[1]), 0U);
    EXPECT_LT(rig.state.organ[1].maxDisplacement, 2e-3);
  }
}

/// Organs at rest that touch or overlap at rest do nothing to one another.
TEST(TissueContact, WhatOverlapsAtRestStaysAtRest) {
  SceneDescription scene = slabAndCube();
  for (Vec3& p : scene.organs[1].surface.vertex) p[2] -= 0.003;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 60; ++i) rig.step(scene.hands[0].home);
  for (std::size_t o = 0; o < 2; ++o) EXPECT_LT(rig.state.organ[o].maxDisplacement, 2e-5) << o;
}

}  // namespace
}  // namespace calot

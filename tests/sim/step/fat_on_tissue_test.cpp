// SPDX-License-Identifier: GPL-3.0-or-later
// Fat against organs and vessels: it does not pass, gains no energy, does not push where it was drawn, and costs
// nothing where it is far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/step/tissue_contacts.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot::fat_on_tissue_test {
namespace {

constexpr double bottom = test::blockTop + 0.004;  ///< of the fat (m)
constexpr double ductRadius = 0.0015;

/// Fat under a slab of tissue, 4 mm above the block.
SceneDescription hangingFat(double cell = 0.001, std::uint32_t ticksPerStep = 10) {
  SceneDescription scene = test::blockScene(400, 8);
  scene.name = "fat over a block";
  scene.ticksPerStep = ticksPerStep;
  OrganDescription slab;
  slab.name = "slab";
  slab.appearance = "gallbladder";
  slab.surface = test::boxSurface(Vec3(-0.015, -0.015, bottom + 0.0092), Vec3(0.015, 0.015, bottom + 0.019), {5, 5, 2});
  slab.tetrahedra = 150;
  scene.organs.push_back(slab);
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(-0.012, -0.010, bottom), Vec3(0.012, 0.010, bottom + 0.009), {8, 8, 4});
  fat.cellSize = cell;
  fat.attachments = {{"slab", 0.0025, 2e7, 2e5}};
  fat.triangle = {Vec3(0.0, -0.02, bottom), Vec3(0.04, 0.0, bottom), Vec3(0.0, 0.02, bottom)};
  fat.triangleDepth = 0.02;
  scene.fat.push_back(fat);
  for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
  return scene;
}

/// The slab is brought down by `way` in half a second.
void lower(SceneDescription& scene, double way) {
  RetractionDescription press;
  press.organ = "slab";
  press.centre = Vec3(0.0, 0.0, bottom + 0.014);
  press.radius = 0.03;
  press.displacement = Vec3(0.0, 0.0, -way);
  press.duration = 0.5;
  press.stiffness = 3000.0;
  press.damping = 30.0;
  scene.retraction.push_back(press);
}

VesselDescription duct(double height) {
  VesselDescription d;
  d.name = "duct";
  d.appearance = "duct";
  d.path = {Vec3(-0.025, 0.001, height), Vec3(0.0, 0.001, height), Vec3(0.025, 0.001, height)};
  d.elements = 25;
  d.radius = ductRadius;
  d.material = {1e6, 0.45, 1050.0, 1.0, 0.005};
  d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
  return d;
}

std::vector<Vec3> middles(const Model& model, const State& state) {
  std::vector<Vec3> out;
  for (const Index8& cube : model.fat()[0]->solid().cubes()) {
    Vec3 sum = Vec3::Zero();
    for (const int n : cube) sum += state.fat[0].solid.position[static_cast<std::size_t>(n)];
    out.push_back(0.125 * sum);
  }
  return out;
}

/// The nearest that the middle of a cube is to the block (m; below zero: inside).
double nearestToBlock(const Model& model, const State& state) {
  const OrganModel& block = model.organs()[0];
  std::vector<Vec3> skin;
  block.embedding.map(state.organ[0].position, skin);
  std::vector<std::uint32_t> all(block.surface.patches().size());
  std::iota(all.begin(), all.end(), 0U);
  double nearest = 1.0;
  for (const Vec3& p : middles(model, state)) {
    const NearestPoint found = nearestPoint(block.surface, skin, all, p, 0.1);
    if (!found.found) continue;
    nearest = std::min(nearest, (found.inside ? -1.0 : 1.0) * std::sqrt(found.point.squaredDistance));
  }
  return nearest;
}

double edgeOf(const Model& model) { return model.fat()[0]->lattice().cell() * model.fat()[0]->cellsPerCube(); }

double forceOf(const State& state) {
  return std::accumulate(state.tissue.force.begin(), state.tissue.force.end(), 0.0);
}

double kineticEnergy(const Model& model, const State& state) {
  double e = 0.0;
  const auto add = [&](const SolidModel& solid, const SolidState& at) {
    for (std::size_t n = 0; n < at.velocity.size(); ++n) e += 0.5 * solid.mass()[n] * at.velocity[n].squaredNorm();
  };
  for (std::size_t o = 0; o < state.organ.size(); ++o) add(model.organs()[o].solid, state.organ[o]);
  add(model.fat()[0]->solid(), state.fat[0].solid);
  return e;
}

/// Throws slab and fat.
void throwDown(State& state, double speed) {
  for (std::vector<Vec3>* v : {&state.organ[1].velocity, &state.fat[0].solid.velocity})
    std::fill(v->begin(), v->end(), Vec3(0.0, 0.0, -speed));
  state.organ[1].quietSteps = state.fat[0].solid.quietSteps = 0;
}

TEST(FatOnTissue, PressedOnAnOrganItDoesNotPass) {
  for (const double cell : {0.00075, 0.001}) {
    for (const std::uint32_t ticks : {2U, 10U, 20U}) {
      SceneDescription scene = hangingFat(cell, ticks);
      lower(scene, 0.008);
      const std::unique_ptr<const Model> model = test::buildModel(scene);
      ASSERT_TRUE(model);
      test::Rig rig(*model);
      double nearest = 1.0;
      double force = 0.0;
      for (double t = 0.0; t < 1.0; t += model->stepSeconds()) {
        const StepResult& result = rig.step(scene.hands[0].home);
        EXPECT_EQ(result.misses, 0U) << "at " << t << " s";
        nearest = std::min(nearest, nearestToBlock(*model, rig.state));
        force = forceOf(rig.state);
      }
      std::printf("cells of %.2f mm, %2u ms: middles of cubes at least %.3f edges away, %.3f N\n", 1e3 * cell, ticks,
                  nearest / edgeOf(*model), force);
      EXPECT_GT(force, 0.05) << "it must be pressed";
      EXPECT_GT(nearest, 0.2 * edgeOf(*model));
    }
  }
}

/// With a heavier slab behind it.
TEST(FatOnTissue, ThrownAtAnOrganItDoesNotPass) {
  for (const std::uint32_t ticks : {2U, 10U, 20U}) {
    for (const double speed : {0.1, 0.5, 1.0}) {
      const std::unique_ptr<const Model> model = test::buildModel(hangingFat(0.001, ticks));
      ASSERT_TRUE(model);
      test::Rig rig(*model);
      throwDown(rig.state, speed);
      double nearest = 1.0;
      for (double t = 0.0; t < 0.3; t += model->stepSeconds()) {
        rig.step(model->scene().hands[0].home);
        nearest = std::min(nearest, nearestToBlock(*model, rig.state));
      }
      std::printf("%2u ms, %.1f m/s: middles of cubes at least %.3f edges away\n", ticks, speed,
                  nearest / edgeOf(*model));
      EXPECT_LT(nearest, 0.6 * edgeOf(*model)) << "it must have come down";
      EXPECT_GT(nearest, (ticks == 20 ? -0.15 : 0.0) * edgeOf(*model));
    }
  }
}

TEST(FatOnTissue, AFreePairGainsNoEnergy) {
  for (const std::uint32_t ticks : {1U, 5U, 10U, 20U}) {
    SceneDescription scene = hangingFat(0.001, ticks);
    scene.organs[0].anchors.clear();
    for (OrganDescription& organ : scene.organs) organ.material.massDamping = 0.0;
    scene.solver.sleeping = false;
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    throwDown(rig.state, 0.3);
    const double most = kineticEnergy(*model, rig.state);
    bool met = false;
    for (double t = 0.0; t < 0.3; t += model->stepSeconds()) {
      rig.step(scene.hands[0].home);
      met = met || forceOf(rig.state) > 0.0;
      EXPECT_LE(kineticEnergy(*model, rig.state), most * (1.0 + 1e-6)) << ticks << " ms, at " << t;
    }
    EXPECT_TRUE(met);
  }
}

TEST(FatOnTissue, AVesselHoldsIt) {
  for (const std::uint32_t ticks : {2U, 10U}) {
    SceneDescription scene = hangingFat(0.001, ticks);
    scene.vessels.push_back(duct(bottom - 0.0022));
    lower(scene, 0.005);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    double nearest = 1.0;
    double sag = 0.0;
    for (double t = 0.0; t < 1.0; t += model->stepSeconds()) {
      rig.step(scene.hands[0].home);
      std::vector<VesselCapsule> capsules;
      vesselCapsules(model->vesselTrees()[0].beams, rig.state.vessel[0], 0, capsules);
      for (const Vec3& p : middles(*model, rig.state)) {
        for (const VesselCapsule& c : capsules) {
          const Vec3 on = c.p0 + closestOnSegment(p, c.p0, c.p1) * (c.p1 - c.p0);
          nearest = std::min(nearest, (p - on).norm());
          sag = std::max(sag, bottom - 0.0022 - on[2]);
        }
      }
    }
    std::printf("%2u ms: middles of cubes at least %.2f mm from the duct's axis, which gives way by %.2f mm\n", ticks,
                1e3 * nearest, 1e3 * sag);
    EXPECT_GT(nearest, ductRadius + 0.2 * edgeOf(*model));
    EXPECT_GT(sag, 0.0002) << "the duct feels it";
  }
}

TEST(FatOnTissue, WhatIsDrawnIntoEachOtherDoesNotPush) {
  SceneDescription scene = hangingFat();
  scene.solver.sleeping = false;
  scene.organs[0].surface = test::boxSurface(Vec3(-0.03, -0.03, -0.015), Vec3(0.03, 0.03, bottom + 0.001), {8, 8, 4});
  scene.vessels.push_back(duct(bottom + 0.0025));
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 100; ++i) {
    const StepResult& result = rig.step(scene.hands[0].home);
    for (const double force : rig.state.tissue.force) EXPECT_EQ(force, 0.0);
    EXPECT_LT(result.contact.tissueDepth, 1e-9);
    EXPECT_LT(result.fat[0].maxDisplacement, 1e-12);
  }
}

TEST(FatOnTissue, WhatIsTiedTouchesOnceItsTiesAreGone) {
  SceneDescription scene = hangingFat();
  scene.organs[0].surface = test::boxSurface(Vec3(-0.03, -0.03, -0.015), Vec3(0.03, 0.03, bottom - 0.0002), {8, 8, 4});
  for (const bool tied : {true, false}) {
    SceneDescription both = scene;
    if (tied) both.fat[0].attachments.push_back({"block", 0.002, 2e7, 2e5});
    lower(both, 0.003);
    const std::unique_ptr<const Model> model = test::buildModel(both);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    for (int i = 0; i < 60; ++i) rig.step(scene.hands[0].home);
    EXPECT_EQ(rig.state.tissue.key.empty(), tied);
    EXPECT_EQ(forceOf(rig.state) > 0.01, !tied);
  }
}

TEST(FatOnTissue, RestoredInMidContactItGoesOnAlike) {
  SceneDescription scene = hangingFat();
  scene.vessels.push_back(duct(bottom - 0.0022));
  lower(scene, 0.008);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig straight(*model);
  test::Rig jumped(*model);
  for (int i = 0; i < 40; ++i) straight.step(scene.hands[0].home);
  ASSERT_GT(forceOf(straight.state), 0.0);
  jumped.state = straight.state;
  jumped.stepper.invalidate();
  for (int i = 0; i < 30; ++i) {
    straight.step(scene.hands[0].home);
    jumped.step(scene.hands[0].home);
    EXPECT_EQ(digestOf(jumped.state), digestOf(straight.state)) << i;
  }
}

TEST(FatOnTissue, WhatIsFarApartIsNotSearched) {
  SceneDescription scene = hangingFat();
  scene.vessels.push_back(duct(bottom - 0.0022));
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  SerialExecutor executor;
  Bodies bodies(*model, executor);
  Surfaces surfaces(*model, bodies, nullptr, executor);
  State state = initialState(*model, 1);
  bodies.beginStep(state);
  TissueTravel travel(*model);
  FatContacts contacts(*model, travel);
  std::vector<ContactBlock> blocks;
  const auto run = [&](double up, bool awake) {
    for (Vec3& p : state.fat[0].solid.position) p[2] += up;
    surfaces.invalidate();
    surfaces.refresh(state);
    const std::vector<bool> bodiesAwake(model->bodies(), awake);
    travel.follow(surfaces, bodies, state, bodiesAwake);
    contacts.run(surfaces, bodies, travel, state, bodiesAwake, blocks);
    return contacts.searches();
  };
  run(0.05, true);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(run(i % 2 == 0 ? 0.0005 : -0.0005, true), 0U);  // 50 mm away
  EXPECT_TRUE(blocks.empty());
  EXPECT_GT(run(-0.0495, true), 0U);
  blocks.clear();
  EXPECT_EQ(run(0.0, true), 0U) << "nothing moved";
  run(-0.002, true);
  EXPECT_FALSE(blocks.empty());
  blocks.clear();
  EXPECT_EQ(run(0.0, false), 0U) << "what sleeps";
  EXPECT_TRUE(blocks.empty());
}

}  // namespace
}  // namespace calot::fat_on_tissue_test

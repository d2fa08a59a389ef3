// SPDX-License-Identifier: GPL-3.0-or-later
// What is tied together and left alone never gains energy, however stiff the ties; and ties pull both sides alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr std::uint64_t seed = 20261122;
constexpr int kickEvery = 250;  // steps
constexpr int kicks = 41;       // 10,250 steps

/// A block held at its bottom, and a duct from a fixed place down into its top.
SceneDescription tiedScene(double factor) {
  SceneDescription scene = test::blockScene(120, 4);
  scene.name = "duct grown to a block";
  scene.organs[0].material.massDamping = 0.0;
  scene.organs[0].material.stiffnessDamping = 0.002;
  VesselDescription d;
  d.name = "duct";
  d.appearance = "duct";
  d.path = {Vec3(-0.03, 0.01, 0.05), Vec3(-0.01, 0.004, 0.03), Vec3(0.0, 0.0, test::blockTop - 0.0005)};
  d.radius = 0.002;
  d.material = {3e5, 0.45, 1050.0, 0.0, 0.001};
  d.ultimateStrain = 50.0;  // this is about ties
  d.start.kind = VesselEndDescription::Kind::fixed;
  d.end = {VesselEndDescription::Kind::organ, "block"};
  d.end.stiffness *= factor;
  scene.vessels.push_back(d);
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  scene.solver.sleeping = false;
  return scene;
}

/// The same with a pad of fat around the duct, on the block.
SceneDescription tiedFatScene(double factor) {
  SceneDescription scene = tiedScene(factor);
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(-0.010, -0.008, test::blockTop + 0.0002),
                                 Vec3(0.008, 0.008, test::blockTop + 0.008), {8, 8, 4});
  fat.cellSize = 0.001;
  fat.material.massDamping = 0.0;
  fat.material.stiffnessDamping = 0.002;
  fat.attachments = {{"block", 0.0015, factor * 3e8, factor * 3e6}, {"duct", 0.001, factor * 3e8, factor * 3e6}};
  scene.fat.push_back(fat);
  return scene;
}

double kinetic(std::span<const double> mass, std::span<const Vec3> velocity) {
  double sum = 0.0;
  for (std::size_t n = 0; n < velocity.size(); ++n) sum += 0.5 * mass[n] * velocity[n].squaredNorm();
  return sum;
}

/// Of everything (J). Fat counts as if all cubes were full.
double kineticEnergy(const Model& model, const State& state) {
  double sum = 0.0;
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    sum += kinetic(model.organs()[o].solid.mass(), state.organ[o].velocity);
  }
  for (std::size_t t = 0; t < state.vessel.size(); ++t) {
    sum += kinetic(model.vesselTrees()[t].beams.mass(), state.vessel[t].velocity);
    sum += kinetic(model.vesselTrees()[t].beams.inertia(), state.vessel[t].angularVelocity);
  }
  for (std::size_t f = 0; f < state.fat.size(); ++f) {
    sum += kinetic(model.fat()[f]->solid().mass(), state.fat[f].solid.velocity);
  }
  return sum;
}

/// Gives every body one velocity, and every free node another, up to `speed` in each direction.
void kick(const Model& model, State& state, Random& random, double speed) {
  const auto any = [&](double most) {
    return Vec3(random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most));
  };
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    const Vec3 common = any(speed);
    for (std::size_t n = 0; n < state.organ[o].velocity.size(); ++n) {
      if (model.organs()[o].solid.row(n) >= 0) state.organ[o].velocity[n] += common + any(0.3 * speed);
    }
  }
  for (std::size_t t = 0; t < state.vessel.size(); ++t) {
    const Vec3 common = any(speed);
    for (std::size_t n = 0; n < state.vessel[t].velocity.size(); ++n) {
      if (!model.vesselTrees()[t].beams.fixed(n)) state.vessel[t].velocity[n] += common + any(0.3 * speed);
    }
  }
  for (FatState& fat : state.fat) {
    const Vec3 common = any(speed);
    for (Vec3& v : fat.solid.velocity) v += common + any(0.3 * speed);
  }
}

struct Ring {
  double maxGrowth = 0.0;  ///< energy over what the last kick left, at any step
  double left = 0.0;       ///< largest share of it at the end of a ring
};

Ring ring(const SceneDescription& scene, int rings) {
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  test::Rig rig(*model);
  const std::vector<TickSamples> still = test::ticksAt(scene, scene.hands[0].home, scene.hands[1].home);
  Random random(seed);
  Ring out;
  for (int k = 0; k < rings; ++k) {
    kick(*model, rig.state, random, 0.1);
    const double start = kineticEnergy(*model, rig.state);
    double now = start;
    for (int i = 0; i < kickEvery; ++i) {
      const StepResult& result = rig.stepper.step(rig.state, still);
      EXPECT_EQ(result.misses & miss::runaway, 0U);
      now = kineticEnergy(*model, rig.state);
      EXPECT_TRUE(std::isfinite(now));
      out.maxGrowth = std::max(out.maxGrowth, now / start);
    }
    out.left = std::max(out.left, now / start);
  }
  return out;
}

class StiffTies : public testing::TestWithParam<double> {};

TEST_P(StiffTies, OfAVesselGainNoEnergy) {
  const Ring r = ring(tiedScene(GetParam()), kicks);
  std::printf("seed %llu, ties x %g: energy at most %.3g of the kick's, %.2g left after %d steps\n",
              static_cast<unsigned long long>(seed), GetParam(), r.maxGrowth, r.left, kickEvery);
  EXPECT_LT(r.maxGrowth, 1.0);
  EXPECT_LT(r.left, 1e-4);
}

TEST_P(StiffTies, OfFatGainNoEnergy) {
  const Ring r = ring(tiedFatScene(GetParam()), kicks);
  std::printf("seed %llu, ties x %g: energy at most %.3g of the kick's, %.2g left after %d steps\n",
              static_cast<unsigned long long>(seed), GetParam(), r.maxGrowth, r.left, kickEvery);
  EXPECT_LT(r.maxGrowth, 1.0);
  EXPECT_LT(r.left, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Factors, StiffTies, testing::Values(1.0, 10.0, 100.0),
                         [](const testing::TestParamInfo<double>& factor) {
                           return "Times" + std::to_string(static_cast<int>(factor.param));
                         });

TEST(TiedPair, OfFatKeepsItsMomentum) {
  for (const double factor : {1.0, 100.0}) {
    SceneDescription scene = tiedFatScene(factor);
    scene.organs[0].anchors.clear();
    scene.vessels[0].start.kind = VesselEndDescription::Kind::free;
    scene.solver.tolerance = 1e-7;  // motion with fat is solved to ten times that
    scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    std::vector<double> fatMass;
    model->fat()[0]->solid().massOf(model->fat()[0]->restFill(), fatMass);
    Random random(seed);
    kick(*model, rig.state, random, 0.05);
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      const auto add = [&](std::span<const double> mass, std::span<const Vec3> velocity) {
        for (std::size_t n = 0; n < velocity.size(); ++n) sum += mass[n] * velocity[n];
      };
      add(model->organs()[0].solid.mass(), rig.state.organ[0].velocity);
      add(model->vesselTrees()[0].beams.mass(), rig.state.vessel[0].velocity);
      add(fatMass, rig.state.fat[0].solid.velocity);
      return sum;
    };
    const Vec3 start = momentum();
    double worst = 0.0;
    for (int i = 0; i < 30; ++i) {
      rig.step(scene.hands[0].home, scene.hands[1].home);
      worst = std::max(worst, (momentum() - start).norm() / start.norm());
    }
    std::printf("seed %llu, ties x %g: momentum kept within %.2g\n", static_cast<unsigned long long>(seed), factor,
                worst);
    EXPECT_LT(worst, factor > 1.0 ? 2e-3 : 2e-5);
  }
}

TEST(TiedPair, KeepsItsMomentum) {
  // A ball in free space with a free duct grown to it: nothing outside pulls.
  SceneDescription scene = test::blockScene(120, 4);
  scene.name = "ball and duct";
  scene.organs[0].tetrahedra = 400;
  scene.organs[0].name = "ball";
  scene.organs[0].surface = test::sphereSurface(Vec3::Zero(), 0.015, 4);
  scene.organs[0].anchors.clear();
  scene.organs[0].material.massDamping = 0.0;
  VesselDescription d;
  d.name = "duct";
  d.appearance = "duct";
  d.path = {Vec3(0.0, 0.002, 0.05), Vec3(0.0, 0.0, 0.014)};
  d.material = {3e5, 0.45, 1050.0, 0.0, 0.005};
  d.ultimateStrain = 50.0;
  d.start.kind = VesselEndDescription::Kind::free;
  d.end = {VesselEndDescription::Kind::organ, "ball"};
  scene.vessels.push_back(d);
  scene.solver.sleeping = false;
  scene.solver.tolerance = 1e-6;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  Random random(seed);
  kick(*model, rig.state, random, 0.05);
  for (Vec3& v : rig.state.vessel[0].velocity) v += Vec3(0.2, -0.1, 0.05);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 0; n < rig.state.organ[0].velocity.size(); ++n) {
      sum += model->organs()[0].solid.mass()[n] * rig.state.organ[0].velocity[n];
    }
    for (std::size_t n = 0; n < rig.state.vessel[0].velocity.size(); ++n) {
      sum += model->vesselTrees()[0].beams.mass()[n] * rig.state.vessel[0].velocity[n];
    }
    return sum;
  };
  const Vec3 start = momentum();
  double worst = 0.0;
  const std::vector<TickSamples> still = test::ticksAt(scene, scene.hands[0].home, scene.hands[1].home);
  for (int i = 0; i < 30; ++i) {
    rig.stepper.step(rig.state, still);
    worst = std::max(worst, (momentum() - start).norm() / start.norm());
  }
  std::printf("seed %llu: momentum kept within %.2g\n", static_cast<unsigned long long>(seed), worst);
  EXPECT_LT(worst, 1e-4);
}

}  // namespace
}  // namespace calot

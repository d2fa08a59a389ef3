// SPDX-License-Identifier: GPL-3.0-or-later
// Two free blocks that connective tissue ties, kicked and left alone: kinetic energy, elastic energy of blocks and
// strands, and what damage has dissipated never grow together; the momentum of the pair is kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <tuple>

#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"
#include "tests/stability/support/solid_checks.h"

namespace calot {
namespace {

constexpr std::uint64_t pairSeed = 20261124;

/// Two blocks of 30 x 30 x 15 mm, 2 mm apart, in free space.
SceneDescription freePair(double factor, std::uint32_t ticksPerStep) {
  SceneDescription scene = test::blockScene(150, 4);
  scene.name = "two free blocks";
  scene.ticksPerStep = ticksPerStep;
  scene.organs[0].anchors.clear();
  scene.organs[0].surface = test::boxSurface(Vec3(-0.015, -0.015, -0.017), Vec3(0.015, 0.015, -0.002), {4, 4, 2});
  scene.organs[0].material = {5000.0, 0.45, 1060.0, 0.0, 0.005};
  OrganDescription upper = scene.organs[0];
  upper.name = "upper";
  upper.surface = test::boxSurface(Vec3(-0.015, -0.015, 0.0), Vec3(0.015, 0.015, 0.015), {4, 4, 2});
  scene.organs.push_back(upper);
  ConnectiveDescription bed;
  bed.name = "bed";
  bed.first = "upper";
  bed.second = "block";
  bed.reach = 0.003;
  bed.stiffness *= factor;
  bed.damping = 0.0;
  // So that the kicks soften it, whatever its stiffness: the energy at its strength is always 0.1 J/m^2.
  bed.strength = 200.0 * std::sqrt(factor);
  bed.fractureEnergy = 0.15;
  scene.connective = {bed};
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.12);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.12);
  scene.solver.sleeping = false;
  scene.solver.tolerance = 1e-6;
  scene.solver.iterations = 1000;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  return scene;
}

struct Energy {
  double organs = 0.0;
  double strands = 0.0;
  double dissipated = 0.0;
  [[nodiscard]] double sum() const { return organs + strands + dissipated; }
};

Energy energyOf(const Model& model, const State& state) {
  Energy out;
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    out.organs += test::energy(model.organs()[o].solid, state.organ[o]);
  }
  const ConnectiveModel& tie = model.connective()[0];
  const CohesiveLaw law = tie.tissue.material().law();
  for (std::size_t s = 0; s < tie.tissue.strands().size(); ++s) {
    const Strand& strand = tie.tissue.strands()[s];
    const double damage = state.connective[0].damage[s];
    out.dissipated += strand.area * law.dissipated(damage);
    if (state.connective[0].condition[s] != StrandCondition::attached) continue;
    const double separation =
        (strand.a.of(state.organ[tie.a].position) - strand.b.of(state.organ[tie.b].position)).norm() -
        strand.restLength;
    out.strands += 0.5 * strand.area * law.secant(separation, damage) * separation * separation;
  }
  return out;
}

Vec3 momentumOf(const Model& model, const State& state) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    for (std::size_t n = 0; n < state.organ[o].velocity.size(); ++n) {
      sum += model.organs()[o].solid.mass()[n] * state.organ[o].velocity[n];
    }
  }
  return sum;
}

/// Three blocks in a row, the outer two tied to the middle one, and a free duct that is grown to it: one system, whose
/// momentum is kept, and in which a kick of one end reaches the other within a step.
TEST(TiedBlocks, ThreeOrgansAndAVesselKeepTheirMomentum) {
  SceneDescription scene = freePair(1.0, 10);
  scene.name = "three free blocks and a duct";
  OrganDescription third = scene.organs[0];
  third.name = "third";
  third.surface = test::boxSurface(Vec3(-0.015, -0.015, 0.017), Vec3(0.015, 0.015, 0.032), {4, 4, 2});
  scene.organs.push_back(third);
  ConnectiveDescription bed = scene.connective[0];
  bed.name = "second-bed";
  bed.first = "third";
  bed.second = "upper";
  scene.connective.push_back(bed);
  VesselDescription duct;
  duct.name = "duct";
  duct.appearance = "duct";
  duct.path = {Vec3(0.05, 0.0, 0.008), Vec3(0.0145, 0.0, 0.0075)};
  duct.material = {3e5, 0.45, 1050.0, 0.0, 0.005};
  duct.ultimateStrain = 50.0;
  duct.start.kind = VesselEndDescription::Kind::free;
  duct.end = {VesselEndDescription::Kind::organ, "upper"};
  scene.vessels.push_back(duct);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (Vec3& v : rig.state.organ[0].velocity) v = Vec3(0.01, 0.0, -0.04);
  const auto momentum = [&] {
    Vec3 sum = momentumOf(*model, rig.state);
    for (std::size_t n = 0; n < rig.state.vessel[0].velocity.size(); ++n) {
      sum += model->vesselTrees()[0].beams.mass()[n] * rig.state.vessel[0].velocity[n];
    }
    return sum;
  };
  const Vec3 start = momentum();
  double worst = 0.0;
  const std::vector<TickSamples> still = test::ticksAt(scene, scene.hands[0].home, scene.hands[1].home);
  for (int i = 0; i < 40; ++i) {
    const StepResult& result = rig.stepper.step(rig.state, still);
    EXPECT_EQ(result.misses, 0U) << i;
    worst = std::max(worst, (momentum() - start).norm() / start.norm());
    if (i > 0) continue;
    double reached = 0.0;
    for (const Vec3& v : rig.state.organ[2].velocity) reached = std::min(reached, v[2]);
    EXPECT_LT(reached, -1e-5);
    reached = 0.0;
    for (const Vec3& v : rig.state.vessel[0].velocity) reached = std::min(reached, v[2]);
    EXPECT_LT(reached, -1e-5);
  }
  std::printf("three blocks and a duct: momentum kept within %.1e\n", worst);
  EXPECT_LT(worst, 1e-4);
}

/// Stiffness of the strands over the scenes', ticks a step.
class TiedPairs : public testing::TestWithParam<std::tuple<double, std::uint32_t>> {};

TEST_P(TiedPairs, GainNoEnergyAndKeepTheirMomentum) {
  const auto [factor, ticks] = GetParam();
  const SceneDescription scene = freePair(factor, ticks);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  Random random(pairSeed);
  double mostGrowth = 0.0;
  double worstMomentum = 0.0;
  double mostDamage = 0.0;
  double torn = 0.0;
  for (int kick = 0; kick < 6; ++kick) {
    test::Rig rig(*model);
    const std::vector<TickSamples> still = test::ticksAt(scene, scene.hands[0].home, scene.hands[1].home);
    // One block flies off, straight, and every node a little on its own; the harder, the more softens and tears.
    const double speed = 0.1 * (1 + kick);
    for (std::size_t o = 0; o < 2; ++o) {
      for (Vec3& v : rig.state.organ[o].velocity) {
        v = 0.1 * speed * Vec3(random.normal(), random.normal(), random.normal());
        if (o == 0) v -= Vec3(0.0, 0.0, speed);
      }
    }
    const double start = energyOf(*model, rig.state).sum();
    const Vec3 momentum = momentumOf(*model, rig.state);
    double before = start;
    const int steps = static_cast<int>(400 / ticks);
    for (int i = 0; i < steps; ++i) {
      const StepResult& result = rig.stepper.step(rig.state, still);
      ASSERT_EQ(result.misses, 0U) << "step " << i;
      const Energy energy = energyOf(*model, rig.state);
      ASSERT_TRUE(std::isfinite(energy.sum()));
      mostGrowth = std::max(mostGrowth, (energy.sum() - before) / start);
      before = energy.sum();
      worstMomentum = std::max(worstMomentum, (momentumOf(*model, rig.state) - momentum).norm() / momentum.norm());
      for (const double d : rig.state.connective[0].damage) mostDamage = std::max(mostDamage, d);
      torn = std::max(torn, result.connective[0].torn);
    }
  }
  std::printf(
      "seed %llu, strands x %g, %u ms: energy grew by at most %.1e of the kick's in a step; momentum kept within %.1e; "
      "damage up to %.2f, torn %.2f\n",
      static_cast<unsigned long long>(pairSeed), factor, ticks, mostGrowth, worstMomentum, mostDamage, torn);
  // Rounding of the single-precision solve, and rotation of the blocks, whose law is linearised once a step.
  EXPECT_LT(mostGrowth, 1e-6);
  EXPECT_LT(worstMomentum, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(StiffnessAndStep, TiedPairs,
                         testing::Combine(testing::Values(0.1, 1.0, 10.0, 100.0), testing::Values(1U, 5U, 10U, 20U)),
                         [](const auto& which) {
                           return "Times" + std::to_string(std::lround(10.0 * std::get<0>(which.param))) +
                                  "TenthsStep" + std::to_string(std::get<1>(which.param));
                         });

}  // namespace
}  // namespace calot

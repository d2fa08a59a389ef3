// SPDX-License-Identifier: GPL-3.0-or-later
// The whole step under hands that shake at 20 Hz with 2 m/s, that teleport, and from states that were tampered with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/math/random.h"
#include "sim/scene/stepper.h"
#include "tests/sim/core/support/scenes.h"

namespace calot {
namespace {

/// How deep a hand's tip stands in the deformed block (m), measured without the contact search: that one looks no
/// deeper than a shaft's radius.
double depthOfTip(const Model& model, const State& state, std::size_t hand) {
  const OrganModel& organ = model.organs()[0];
  TriangleMesh mesh;
  organ.embedding.map(state.organ[0].position, mesh.vertex);
  mesh.triangle = organ.surface.triangles();
  const SurfaceDistance distance(std::move(mesh), InsideRule::pseudonormal);
  const HandDescription& description = model.scene().hands[hand];
  const Vec3 axis = (state.hand[hand].simulatedPosition - description.port).normalized();
  const Vec3 centre = state.hand[hand].simulatedPosition - description.shaftRadius * axis;
  return description.shaftRadius - distance.signedDistance(centre);
}

/// What every step promises, whatever happens: finite numbers, and a miss that is told.
void expectHonest(const Model& model, const State& state, const StepResult& result) {
  ASSERT_TRUE(test::allFinite(state));
  ASSERT_TRUE(test::allFinite(result));
  const SolverDescription& solver = model.scene().solver;
  bool solverEvent = false;
  bool contactEvent = false;
  for (const Event& event : result.events) {
    solverEvent = solverEvent || event.kind == EventKind::solverMiss;
    contactEvent = contactEvent || event.kind == EventKind::contactMiss;
  }
  const bool solverMissed = (result.misses & miss::solver) != 0;
  const bool contactMissed = (result.misses & miss::contact) != 0;
  EXPECT_EQ(solverMissed, solverEvent);
  EXPECT_EQ(contactMissed, contactEvent);
  EXPECT_EQ(contactMissed, result.contact.residual > solver.contactTolerance);
  for (const OrganResult& organ : result.organ) {
    EXPECT_TRUE(solverMissed || organ.residual <= solver.tolerance) << organ.residual;
  }
}

/// Tips that swing by +-16 mm at 20 Hz (2 m/s at the middle) in a random direction that turns, about a place near the
/// block's top that wanders.
struct Shaking {
  std::array<Vec3, handCount> centre;
  std::array<Vec3, handCount> direction;
  std::array<double, handCount> phase;
  explicit Shaking(Random& random) {
    for (std::size_t h = 0; h < handCount; ++h) {
      centre[h] =
          Vec3((h == 0 ? -0.012 : 0.012) + 0.004 * random.normal(), 0.008 * random.normal(), test::blockTop + 0.004);
      direction[h] = Vec3(random.normal(), random.normal(), random.normal()).normalized();
      phase[h] = random.uniform() * 2.0 * std::numbers::pi;
    }
  }
  [[nodiscard]] Vec3 at(std::size_t h, double t) const {
    const double amplitude = 2.0 / (2.0 * std::numbers::pi * 20.0);
    const Vec3 turned = Eigen::AngleAxisd(1.3 * t, Vec3::UnitY()) * direction[h];
    return centre[h] + amplitude * std::sin(2.0 * std::numbers::pi * 20.0 * t + phase[h]) * turned;
  }
};

TEST(ViolentHands, ShakingAtTwentyHertz) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(500, 8));
  ASSERT_TRUE(model);
  double deepest = 0.0;
  double strongest = 0.0;
  int misses = 0;
  int touched = 0;
  for (const std::uint64_t seed : {91U, 92U, 93U, 94U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Shaking shaking(random);
    test::Rig rig(*model);
    std::array<HapticState, handCount> haptic;
    for (int step = 0; step < 300; ++step) {
      std::vector<TickSamples> ticks = test::ticksAt(model->scene(), Vec3::Zero(), Vec3::Zero());
      for (std::size_t k = 0; k < ticks.size(); ++k) {
        for (std::size_t h = 0; h < handCount; ++h) {
          ticks[k].hand[h].position = shaking.at(h, 0.01 * step + 0.001 * static_cast<double>(k));
          takeSample(*model, h, ticks[k].hand[h], haptic[h]);
          const Vec3 force = hapticTick(hapticModel(*model, h), haptic[h], rig.stepper.contactSet(h)).force;
          ASSERT_TRUE(force.allFinite());
          ASSERT_LE(force.norm(), model->scene().hands[h].largestForce * (1.0 + 1e-12));
        }
      }
      const StepResult& result = rig.stepper.step(rig.state, ticks);
      expectHonest(*model, rig.state, result);
      if (HasFatalFailure()) return;
      for (std::size_t h = 0; h < handCount; ++h) {
        deepest = std::max(deepest, depthOfTip(*model, rig.state, h));
        strongest = std::max(strongest, result.hand[h].contactForce.norm());
        touched += result.hand[h].touching != 0 ? 1 : 0;
      }
      misses += result.misses != 0 ? 1 : 0;
    }
    // The hands go home: the block recovers its shape.
    for (int i = 0; i < 300; ++i) rig.step(model->scene().hands[0].home);
    EXPECT_LT(rig.state.organ[0].largestDisplacement, 1e-3);
  }
  std::printf("deepest tip %.3f mm, strongest contact %.2f N, %d steps with misses, %d touches\n", 1e3 * deepest,
              strongest, misses, touched);
  // Once the axis itself is inside, the contact search may lose the face behind it: that must not happen.
  EXPECT_LT(deepest, model->scene().hands[0].shaftRadius);
  EXPECT_GT(touched, 200) << "the run must press";
}

/// Tips that are somewhere else in every step, everywhere in the workspace, in and behind the organ.
TEST(ViolentHands, Teleporting) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(300, 6));
  ASSERT_TRUE(model);
  SCOPED_TRACE("seed 95");
  Random random(95);
  test::Rig rig(*model);
  const auto anywhere = [&] {
    return Vec3(random.uniform(-0.16, 0.16), random.uniform(-0.16, 0.16), random.uniform(-0.16, 0.16));
  };
  for (int step = 0; step < 400; ++step) {
    const Vec3 left = anywhere();
    const Vec3 right = random.uniform() < 0.2 ? model->scene().hands[1].port : anywhere();
    const StepResult& result = rig.step(left, right);
    expectHonest(*model, rig.state, result);
    ASSERT_FALSE(HasFatalFailure()) << "step " << step;
  }
}

/// A State whose bits were turned is refused, or it is stepped without leaving the finite numbers unnoticed.
TEST(ViolentHands, TamperedStates) {
  const std::unique_ptr<const Model> model = test::buildModel(test::blockScene(300, 6));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 40; ++i) rig.step(Vec3(-0.005, 0.0, 0.03 - 0.0004 * i));
  ASSERT_NE(rig.state.hand[0].touching, 0U);
  const std::vector<std::byte> bytes = saveState(rig.state);
  SCOPED_TRACE("seed 96");
  Random random(96);
  int restored = 0;
  for (int trial = 0; trial < 150; ++trial) {
    std::vector<std::byte> turned = bytes;
    for (int k = 0; k < 1 + trial % 3; ++k) {
      turned[random.next() % turned.size()] ^= static_cast<std::byte>(1U << (random.next() % 8U));
    }
    test::Rig other(*model);
    if (!restoreState(*model, turned, other.state)) continue;
    ++restored;
    EXPECT_EQ(saveState(other.state), turned) << "trial " << trial;
    for (int i = 0; i < 2; ++i) {
      other.step(Vec3(-0.005, 0.0, 0.014));
      test::FiniteCheck check;
      State::components(other.state,
                        [&](const auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, check); });
      EXPECT_TRUE(check.finite) << "trial " << trial << ": " << check.field;
    }
  }
  EXPECT_GT(restored, 50);
}

}  // namespace
}  // namespace calot

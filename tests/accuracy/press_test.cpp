// SPDX-License-Identifier: GPL-3.0-or-later
// A tip that presses on a held elastic block until all is still: balances of force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sim/haptics/haptic_tick.h"
#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// Goes down to the given tips and waits until the block is still. @returns the last step's result.
StepResult press(const Model& model, State& state, Stepper& stepper, const Vec3& left, const Vec3& right) {
  StepResult result;
  for (int i = 0; i < 500; ++i) {
    const double down = std::min(1.0, (i + 1) / 40.0);
    const auto way = [&](std::size_t h, const Vec3& goal) -> Vec3 {
      const Vec3 start(goal[0], goal[1], 0.03);
      return goal[2] >= 0.03 ? model.scene().hands[h].home : Vec3(start + down * (goal - start));
    };
    result = stepper.step(state, test::ticksAt(model.scene(), way(0, left), way(1, right)));
    EXPECT_EQ(result.misses, 0U);
    if (down == 1.0 && i > 60 && result.organ[0].maxSpeed < 1e-6) break;
  }
  // Times the damping of 0.02 s that is two micrometres: nothing beside millimetres of indentation.
  EXPECT_LT(result.organ[0].maxSpeed, 1e-4) << "m/s";
  return result;
}

/// Force of the held nodes on the block (N).
Vec3 reaction(const OrganModel& organ, const SolidState& state) {
  std::vector<RotationGroup> rotation = state.rotation;
  std::vector<ElementResult> result(organ.solid.elements().groups().size());
  SerialExecutor executor;
  organ.solid.elements().evaluate(state.position, state.velocity, 0.0, organ.solid.material().lame, 10, rotation,
                                  result, executor);
  Vec3 sum = Vec3::Zero();
  for (std::size_t e = 0; e < organ.solid.tetrahedra().size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      const int node = organ.solid.tetrahedra()[e][static_cast<int>(a)];
      if (organ.solid.row(static_cast<std::size_t>(node)) >= 0) continue;
      const auto& lanes = result[e / laneCount].force[a];
      sum -= Vec3(lanes[0][e % laneCount], lanes[1][e % laneCount], lanes[2][e % laneCount]);
    }
  }
  return sum;
}

const Vec3 away(0.012, 0.0, 0.04);

/// Straight down under the port: the force on the tip, the virtual coupling's pull, the sum of the contact forces and
/// the reaction of the held nodes are one and the same force.
TEST(Press, ForcesBalance) {
  SceneDescription scene = test::blockScene(1500, 16);
  scene.hands[0].port = Vec3(0.0011, 0.0023, 0.13);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  for (const double depth : {0.002, 0.006}) {
    SCOPED_TRACE("depth " + std::to_string(depth));
    SerialExecutor executor;
    State state = initialState(*model, 1);
    Stepper stepper(*model, executor);
    const Vec3 goal(0.0011, 0.0023, test::blockTop - depth);
    const StepResult result = press(*model, state, stepper, goal, away);
    const HandResult& hand = result.hand[0];
    const Vec3 force = hand.contactForce;
    ASSERT_GT(force[2], 0.01);
    const Vec3 coupling = scene.hands[0].couplingStiffness * (hand.tipSimulated - hand.tipReal);
    EXPECT_LT((coupling - force).norm(), 1e-9 * force.norm()) << "the coupling holds against the contact";
    const double mu = scene.organs[0].friction;
    EXPECT_GE(hand.structureForce[0] * std::sqrt(1.0 + mu * mu), force.norm() * 0.99)
        << "normal forces and what friction may add are no less than the sum";
    const Vec3 held = reaction(model->organs()[0], state.organ[0]);
    EXPECT_NEAR(held[2], force[2], 0.01 * force[2]) << "the block rests on its held nodes";
    // Sideways the lever between contact and tip, a radius apart, stands between the two.
    EXPECT_LT((held - force).norm(), 0.03 * force.norm());
    // The ticks feel the same force, once what an earlier set said is let go.
    HapticState haptic = initialHaptics(state, 0);
    Vec3 felt = Vec3::Zero();
    for (int tick = 0; tick < 200; ++tick) {
      felt = hapticTick(hapticModel(*model, 0), haptic, stepper.contactSet(0)).force;
    }
    EXPECT_LT((felt - force).norm(), 0.01 * force.norm());
  }
}

/// Without friction an oblique instrument is pushed along the face's normal, not along itself. 0.5 mm deep, so that the
/// face stays nearly flat.
TEST(Press, AnObliqueInstrumentFeelsTheFacesNormal) {
  SceneDescription scene = test::blockScene(1500, 16);
  const Vec3 goal(0.0011, 0.0023, test::blockTop - 0.0005);
  scene.hands[0].port = goal + 0.12 * Vec3(1.0, 0.0, 1.0).normalized();
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  SerialExecutor executor;
  State state = initialState(*model, 1);
  Stepper stepper(*model, executor);
  const Vec3 force = press(*model, state, stepper, goal, away).hand[0].contactForce;
  ASSERT_GT(force[2], 1e-3);
  const double angle = std::acos(force[2] / force.norm()) * 180.0 / 3.14159265358979;
  EXPECT_LT(angle, 8.0) << "degrees from the normal; the shaft stands at 45";
}

/// The force is that of the tissue, not of the cells: on coarse meshes and fine ones it is the same.
TEST(Press, ForceDoesNotDependOnTheMesh) {
  std::vector<double> force;
  for (const std::uint32_t tetrahedra : {300U, 1200U, 4800U}) {
    SceneDescription scene = test::blockScene(tetrahedra, 16);
    scene.hands[0].port = Vec3(0.0011, 0.0023, 0.13);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    SerialExecutor executor;
    State state = initialState(*model, 1);
    Stepper stepper(*model, executor);
    force.push_back(
        press(*model, state, stepper, Vec3(0.0011, 0.0023, test::blockTop - 0.004), away).hand[0].contactForce[2]);
  }
  std::printf("press of 4 mm: %.4f N, %.4f N, %.4f N\n", force[0], force[1], force[2]);
  EXPECT_NEAR(force[0], force[2], 0.10 * force[2]);
  EXPECT_NEAR(force[1], force[2], 0.10 * force[2]);
}

/// With a coupling that hardly yields, the force of a given displacement is proportional to Young's modulus.
TEST(Press, ForceIsProportionalToStiffness) {
  double force[2] = {};
  for (const int k : {0, 1}) {
    SceneDescription scene = test::blockScene(700);
    scene.hands[0].port = Vec3(0.0011, 0.0023, 0.13);
    scene.hands[0].couplingStiffness = 1e5;
    scene.organs[0].material.youngModulus = 3000.0 * (k + 1);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    SerialExecutor executor;
    State state = initialState(*model, 1);
    Stepper stepper(*model, executor);
    force[k] =
        press(*model, state, stepper, Vec3(0.0011, 0.0023, test::blockTop - 0.003), away).hand[0].contactForce[2];
  }
  EXPECT_NEAR(force[1] / force[0], 2.0, 0.02);
}

/// Two hands at once: each feels what it feels with the roles exchanged, and the block carries the sum.
TEST(Press, HandsAreEqual) {
  SceneDescription scene = test::blockScene(1500, 16);
  scene.hands[0].port = Vec3(-0.0083, 0.0023, 0.13);
  scene.hands[1].port = Vec3(0.0091, 0.0031, 0.13);
  const Vec3 a(-0.0083, 0.0023, test::blockTop - 0.003);
  const Vec3 b(0.0091, 0.0031, test::blockTop - 0.004);
  StepResult result[2];
  State last;
  for (const int k : {0, 1}) {
    if (k == 1) std::swap(scene.hands[0], scene.hands[1]);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    SerialExecutor executor;
    last = initialState(*model, 1);
    Stepper stepper(*model, executor);
    result[k] = press(*model, last, stepper, k == 0 ? a : b, k == 0 ? b : a);
    const Vec3 sum = result[k].hand[0].contactForce + result[k].hand[1].contactForce;
    EXPECT_NEAR(reaction(model->organs()[0], last.organ[0])[2], sum[2], 0.01 * sum[2]);
  }
  for (std::size_t h = 0; h < 2; ++h) {
    const Vec3& one = result[0].hand[h].contactForce;
    EXPECT_LT((one - result[1].hand[1 - h].contactForce).norm(), 1e-3 * one.norm())
        << "the hands' numbers do not matter";
  }
}

}  // namespace
}  // namespace calot

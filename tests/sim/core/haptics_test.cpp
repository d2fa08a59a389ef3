// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/haptics/haptic_tick.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "sim/scene/stepper.h"
#include "tests/sim/core/support/scenes.h"

namespace calot {
namespace {

/// One row that pushes up, in closed form.
ContactSet oneRow(double free) {
  ContactSet set;
  set.step = 4;
  set.direction = {Vec3::UnitZ()};
  set.free = {free};
  set.compliance = {2e-3};
  set.key = {1};
  set.lambda = {0.0};
  return set;
}

TEST(HapticTick, NoContactsNoForce) {
  HapticState state;
  state.lambda = {3.0};
  const HapticForce force = hapticTick({}, state, {});
  EXPECT_TRUE(force.force.isZero(0.0));
  EXPECT_TRUE(force.torque.isZero(0.0));
}

TEST(HapticTick, OneRowIsASpring) {
  const ContactSet set = oneRow(-0.002);
  HapticState state;
  EXPECT_NEAR(hapticTick({}, state, set).force[2], 1.0, 1e-12) << "2 mm over 2 mm/N";
  state.tip = Vec3(0.5, -0.3, -0.004);
  EXPECT_NEAR(hapticTick({}, state, set).force[2], 3.0, 1e-12) << "4 mm deeper; sideways is free";
  state.tip = Vec3(0.0, 0.0, 0.003);
  EXPECT_EQ(hapticTick({}, state, set).force[2], 0.0) << "contact pushes, it never pulls";
}

TEST(HapticTick, ForceIsBoundedInSizeNotInDirection) {
  ContactSet set = oneRow(-0.002);
  set.direction = {Vec3(0.6, 0.0, 0.8)};
  HapticModel model;
  model.largestForce = 2.5;
  HapticState state;
  state.tip = Vec3(0.0, 0.0, -10.0);
  const Vec3 force = hapticTick(model, state, set).force;
  EXPECT_NEAR(force.norm(), 2.5, 1e-12);
  EXPECT_LT((force.normalized() - set.direction[0]).norm(), 1e-12);
}

class HapticRun : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(test::blockScene()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }
  static inline std::unique_ptr<const Model> model_;
};

/// At the pose for which the step solved, the reduced problem has the step's own solution. The bound: a residual of
/// `tolerance` metres in a row is at most tolerance times the coupling's stiffness in force, a few rows of it.
TEST_F(HapticRun, ReproducesTheStepsForceAtTheStepsPose) {
  test::Rig rig(*model_);
  std::array<HapticState, handCount> haptic;
  int touched = 0;
  for (int i = 0; i < 100; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const StepResult& result = rig.step(tips.left, tips.right);
    for (std::size_t h = 0; h < handCount; ++h) {
      const HapticModel model = hapticModel(*model_, h);
      haptic[h].tip = rig.state.hand[h].realPosition;
      const HapticForce force = hapticTick(model, haptic[h], rig.stepper.contactSet(h));
      EXPECT_LE(force.force.norm(), model.largestForce * (1.0 + 1e-12));
      Vec3 expected = result.hand[h].contactForce;
      if (expected.norm() > model.largestForce) expected *= model.largestForce / expected.norm();
      const double rows = static_cast<double>(rig.stepper.contactSet(h).free.size());
      EXPECT_LE((force.force - expected).norm(), (1.0 + rows) * model.tolerance * 1000.0)
          << "step " << i << " hand " << h;
      if (result.hand[h].touching != 0) ++touched;
      EXPECT_TRUE(rows > 0.0 || force.force.isZero(0.0)) << "no contacts, no force";
    }
  }
  EXPECT_GT(touched, 60);
}

/// Between two steps the force follows the hand: pressing on makes it grow, at once.
TEST_F(HapticRun, FollowsTheHandBetweenSteps) {
  test::Rig rig(*model_);
  const Vec3 pressing(-0.005, 0.002, test::blockTop - 0.001);
  for (int i = 0; i < 30; ++i) rig.step(pressing);
  ASSERT_NE(rig.state.hand[0].touching, 0U);
  const HapticModel model = hapticModel(*model_, 0);
  HapticState haptic;
  double previous = 0.0;
  for (int tick = 0; tick < 10; ++tick) {
    InstrumentSample sample;
    sample.position = pressing - 2e-4 * tick * Vec3::UnitZ();
    takeSample(*model_, 0, sample, haptic);
    const double now = hapticTick(model, haptic, rig.stepper.contactSet(0)).force[2];
    EXPECT_GT(now, previous);
    EXPECT_LT(now - previous, tick == 0 ? 10.0 : 0.21) << "no more than the coupling's 1000 N/m";
    previous = now;
  }
  InstrumentSample lost;
  lost.position = Vec3::Zero();
  lost.valid = false;
  const Vec3 before = haptic.tip;
  takeSample(*model_, 0, lost, haptic);
  EXPECT_EQ(haptic.tip, before) << "no measurement holds the tip";
  InstrumentSample away;
  away.position = Vec3(-0.005, 0.002, test::blockTop + 0.02);
  takeSample(*model_, 0, away, haptic);
  EXPECT_TRUE(hapticTick(model, haptic, rig.stepper.contactSet(0)).force.isZero(0.0)) << "lifted off";
}

}  // namespace
}  // namespace calot

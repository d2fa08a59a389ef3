// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/haptics/haptic_tick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// One row that pushes up, in closed form.
ContactSet oneRow(double free) {
  ContactSet set;
  set.step = 4;
  set.kind = {BlockKind::unilateral};
  set.limit = {0.0};
  set.direction = {ToolRow(0.0, 0.0, 1.0, 0.0)};
  set.free = {free};
  set.rate = {0.0};
  set.compliance = {2e-3};
  set.lambda = {0.0};
  return set;
}

/// Ticks until the difference to what an earlier set said is let go.
HapticForce settled(const HapticModel& model, HapticState& state, const ContactSet& set) {
  HapticForce force;
  for (int i = 0; i < 400; ++i) force = hapticTick(model, state, set);
  return force;
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
  EXPECT_NEAR(settled({}, state, set).force[2], 1.0, 1e-12) << "2 mm over 2 mm/N";
  state.tip = Vec3(0.001, -0.002, -0.004);
  EXPECT_NEAR(hapticTick({}, state, set).force[2], 3.0, 1e-12) << "4 mm deeper; sideways is free";
  state.tip = Vec3(0.0, 0.0, 0.003);
  EXPECT_NEAR(hapticTick({}, state, set).force[2], 0.0, 1e-15) << "contact pushes, it never pulls";
}

/// The virtual coupling cannot stretch farther than the device's force takes it.
TEST(HapticTick, TheStretchSaturates) {
  const ContactSet set = oneRow(0.0);
  HapticModel model;
  model.maxStretch = 0.003;
  HapticState state;
  state.tip = Vec3(0.0, 0.0, -0.003);
  const double most = settled(model, state, set).force[2];
  EXPECT_NEAR(most, 1.5, 1e-12);
  state.tip = Vec3(0.0, 0.0, -0.5);
  EXPECT_NEAR(hapticTick(model, state, set).force[2], most, 1e-12);
  const Pose origin;
  EXPECT_LT(
      (couplingStretch(origin, {Vec3(0.3, 0.0, 0.4), origin.orientation}, 0.001) - ToolRow(0.0006, 0.0, 0.0008, 0.0))
          .norm(),
      1e-15);
  const Quat rolled(Eigen::AngleAxisd(2.0, Vec3::UnitZ()));
  EXPECT_NEAR(couplingStretch(origin, {Vec3::Zero(), rolled}, 0.001)[3], maxRollStretch, 1e-12);
}

TEST(HapticTick, ForceIsBoundedInSizeNotInDirection) {
  ContactSet set = oneRow(-0.02);
  set.direction = {ToolRow(0.6, 0.0, 0.8, 0.0)};
  HapticModel model;
  model.maxForce = 2.5;
  HapticState state;
  const Vec3 force = settled(model, state, set).force;
  EXPECT_NEAR(force.norm(), 2.5, 1e-12);
  EXPECT_LT((force.normalized() - Vec3(0.6, 0.0, 0.8)).norm(), 1e-9);
}

/// A row with a lever about the axis gives a torque about it, turned with the real instrument.
TEST(HapticTick, TorqueActsAboutTheShaft) {
  ContactSet set = oneRow(-0.002);
  set.direction = {ToolRow(0.0, 0.0, 1.0, 0.003)};
  HapticState state;
  state.orientation = Quat(Eigen::AngleAxisd(0.9, Vec3::UnitX()));
  set.reference.orientation = state.orientation;
  const HapticForce force = settled({}, state, set);
  const Vec3 axis = state.orientation * Vec3::UnitZ();
  EXPECT_LT((force.torque - force.force[2] * 0.003 * axis).norm(), 1e-12);
  EXPECT_NEAR(force.force[2], 1.0, 1e-9);
}

/// A set that says something else does not step the force: what is left of the difference shrinks by a constant share.
TEST(HapticTick, AChangeOfSetsIsLetGoOverTicks) {
  HapticState state;
  settled({}, state, oneRow(-0.002));
  ContactSet next = oneRow(-0.004);
  next.step = 5;
  double previous = 1.0;
  double share = 0.0;
  for (int tick = 0; tick < 60; ++tick) {
    const double now = hapticTick({}, state, next).force[2];
    EXPECT_GT(now, previous);
    EXPECT_LT(now - previous, 0.101) << "a tenth of the 1 N between them";
    const double left = (2.0 - now) / (2.0 - previous);
    if (tick > 0) {
      EXPECT_NEAR(left, share, 1e-9);
    }
    share = left;
    previous = now;
  }
  EXPECT_NEAR(previous, 2.0, 0.01);
}

/// Rows open or close at their own rate while the set is in use, for as long as a step lasts.
TEST(HapticTick, RowsFollowTheTissuesOwnMotion) {
  ContactSet set = oneRow(-0.002);
  set.rate = {-0.1};
  HapticModel model;
  HapticState state;
  state.set = set.step;
  state.lambda = {0.0};
  for (int tick = 1; tick <= 15; ++tick) {
    const double expected = (0.002 + 0.1 * 0.001 * std::min(tick, 10)) / 2e-3;
    EXPECT_NEAR(hapticTick(model, state, set).force[2], expected, 1e-12) << "tick " << tick;
  }
}

TEST(HapticTick, SetsThatDoNotFitAreRecognised) {
  const ContactSet good = oneRow(-0.002);
  EXPECT_TRUE(isConsistent(good));
  EXPECT_TRUE(isConsistent(ContactSet{}));
  const auto refused = [&](auto&& spoil) {
    ContactSet set = good;
    spoil(set);
    return !isConsistent(set);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](ContactSet& s) { s.kind = {BlockKind::bilateral}; }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.kind = {static_cast<BlockKind>(3)}; }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.limit.clear(); }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.free.push_back(0.0); }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.rate.clear(); }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.lambda.push_back(0.0); }));
  EXPECT_TRUE(refused([](ContactSet& s) { s.compliance = {0.0}; }));
  EXPECT_TRUE(refused([&](ContactSet& s) { s.free = {nan}; }));
  EXPECT_TRUE(refused([&](ContactSet& s) { s.compliance = {nan}; }));
  EXPECT_TRUE(refused([&](ContactSet& s) { s.direction[0][3] = nan; }));
  EXPECT_TRUE(refused([&](ContactSet& s) { s.reference.position[1] = nan; }));
  HapticState state;
  EXPECT_TRUE(isConsistent(state, good)) << "another set's forces are replaced";
  state.set = good.step;
  EXPECT_FALSE(isConsistent(state, good)) << "the same set, and not its number of rows";
  state.lambda = {1.0};
  EXPECT_TRUE(isConsistent(state, good));
}

class HapticRun : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(test::blockScene()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }
  static inline std::unique_ptr<const Model> model_;
};

/// At the pose for which the step solved, with the tissue where the step left it, the reduced problem has the step's
/// own solution. The bound: a residual of `tolerance` metres in a row is at most tolerance times the coupling's
/// stiffness in force, a few rows of it.
TEST_F(HapticRun, ReproducesTheStepsForceAtTheStepsPose) {
  test::Rig rig(*model_);
  int touched = 0;
  for (int i = 0; i < 100; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const StepResult& result = rig.step(tips.left, tips.right);
    for (std::size_t h = 0; h < handCount; ++h) {
      const HapticModel model = hapticModel(*model_, h);
      ContactSet set = rig.stepper.contactSet(h);
      EXPECT_TRUE(isConsistent(set));
      std::fill(set.rate.begin(), set.rate.end(), 0.0);
      HapticState haptic;
      haptic.tip = rig.state.hand[h].input.position;
      haptic.orientation = rig.state.hand[h].input.orientation;
      haptic.set = set.step;
      haptic.lambda = set.lambda;
      const HapticForce force = hapticTick(model, haptic, set);
      EXPECT_LE(force.force.norm(), model.maxForce * (1.0 + 1e-12));
      Vec3 expected = result.hand[h].contactForce;
      if (expected.norm() > model.maxForce) expected *= model.maxForce / expected.norm();
      const double rows = static_cast<double>(set.free.size());
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
  ASSERT_NE(rig.state.hand[0].touches.structures, 0U);
  const HapticModel model = hapticModel(*model_, 0);
  HapticState haptic = initialHaptics(rig.state, 0);
  settled(model, haptic, rig.stepper.contactSet(0));
  double previous = haptic.force[2];
  for (int tick = 1; tick < 10; ++tick) {
    InstrumentSample sample;
    sample.position = pressing - 2e-4 * tick * Vec3::UnitZ();
    takeSample(*model_, 0, sample, haptic);
    const double now = hapticTick(model, haptic, rig.stepper.contactSet(0)).force[2];
    EXPECT_GT(now, previous);
    EXPECT_LT(now - previous, 0.21) << "no more than the coupling's 1000 N/m";
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
  EXPECT_LT(hapticTick(model, haptic, rig.stepper.contactSet(0)).force.norm(), 1e-12) << "lifted off";
}

}  // namespace
}  // namespace calot

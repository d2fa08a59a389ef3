// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws that close on tissue hold it, slip over one force and tear over another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "tests/sim/scene/support/loop.h"

namespace calot {
namespace {

/// Firm tissue, so that a few millimetres of pull are several newtons.
SceneDescription firmBlock() {
  SceneDescription scene = test::blockScene(700, 16);
  scene.organs[0].material.youngModulus = 60e3;
  scene.hands[0].port = Vec3(0.0, 0.0, 0.16);
  scene.hands[0].home = Vec3(0.001, 0.002, 0.04);
  return scene;
}

class Grasping : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(firmBlock()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(model_);
    rig_ = std::make_unique<test::Rig>(*model_);
  }

  /// One step of the left hand; keeps the events and the step's promises.
  const StepResult& step(const Vec3& tip, double jaw, std::uint8_t buttons = 0) {
    std::vector<TickSamples> ticks = test::ticksAt(model_->scene(), tip, model_->scene().hands[1].home);
    for (TickSamples& tick : ticks) {
      tick.hand[0].jaw = jaw;
      tick.hand[0].buttons = buttons;
    }
    const StepResult& result = rig_->stepper.step(rig_->state, ticks);
    EXPECT_EQ(result.misses & miss::contact, 0U);
    EXPECT_TRUE(test::allFinite(rig_->state));
    for (const Event& event : result.events) events_.push_back(event);
    return result;
  }
  [[nodiscard]] int count(EventKind kind) const {
    return static_cast<int>(
        std::count_if(events_.begin(), events_.end(), [&](const Event& e) { return e.kind == kind; }));
  }
  /// Comes down with open jaws to a little above the top, closes them, waits.
  void grasp(std::uint8_t buttons = 0) {
    for (int i = 0; i <= 30; ++i) step(hold_ + (1.0 - i / 30.0) * Vec3(0.0, 0.0, 0.02), 0.6);
    for (int i = 1; i <= 20; ++i) step(hold_, 0.6 * (1.0 - i / 20.0), buttons);
    for (int i = 0; i < 30; ++i) step(hold_, 0.0, buttons);
    ASSERT_EQ(count(EventKind::graspBegin), 1);
    ASSERT_EQ(rig_->state.hand[0].grasp.structure, 0U);
  }
  /// Height of the held skin (m).
  [[nodiscard]] double heldHeight() const {
    const HandState& hand = rig_->state.hand[0];
    std::vector<Vec3> skin;
    model_->organs()[0].embedding.map(rig_->state.organ[0].position, skin);
    Vec3 p = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) p += hand.grasp.weight[0][static_cast<int>(c)] * skin[hand.grasp.node[0][c]];
    return p[2];
  }

  const Vec3 hold_{0.001, 0.002, test::blockTop + 0.0005};
  static inline std::unique_ptr<const Model> model_;
  std::unique_ptr<test::Rig> rig_;
  std::vector<Event> events_;
};

TEST_F(Grasping, HeldTissueFollowsAndPullsBack) {
  grasp();
  const double before = heldHeight();
  double previous = 0.0;
  for (const double pull : {0.001, 0.002, 0.003}) {
    for (int i = 0; i < 60; ++i) step(hold_ + Vec3(0.0, 0.0, pull), 0.0);
    const StepResult& result = step(hold_ + Vec3(0.0, 0.0, pull), 0.0);
    EXPECT_EQ(result.hand[0].grasping, 1U);
    EXPECT_GT(result.hand[0].graspForce, previous + 0.02) << pull;
    previous = result.hand[0].graspForce;
    // The tissue goes as far as the simulated tip does, the coupling's stretch less than the hand.
    const double risen = heldHeight() - before;
    EXPECT_NEAR(risen, rig_->state.hand[0].instrument.position[2] - hold_[2], 3e-4);
    EXPECT_GT(risen, 0.35 * pull);
    EXPECT_LT(result.hand[0].contactForce[2], 0.0) << "it pulls the instrument down";
  }
  EXPECT_EQ(count(EventKind::graspSlip), 0);
  // Opened jaws let go, and the block is as it was.
  for (int i = 0; i < 150; ++i) step(hold_ + Vec3(0.0, 0.0, 0.02), 0.6);
  EXPECT_EQ(count(EventKind::graspEnd), 1);
  EXPECT_EQ(count(EventKind::tissueTear), 0);
  EXPECT_EQ(rig_->state.hand[0].grasp.structure, noStructure);
  EXPECT_LT(rig_->state.organ[0].maxDisplacement, 2e-4);
}

TEST_F(Grasping, SlipsOverTheStatedForce) {
  grasp();
  const double limit = model_->scene().hands[0].slipForce;
  double strongest = 0.0;
  for (int i = 0; i < 250 && rig_->state.hand[0].grasp.structure != noStructure; ++i) {
    strongest = std::max(strongest, step(hold_ + Vec3(0.0, 0.0, 2e-4 * i), 0.0).hand[0].graspForce);
    if (count(EventKind::graspSlip) == 0) {
      EXPECT_LT(strongest, limit * 1.001) << "below the stated force nothing slips";
    }
  }
  EXPECT_EQ(count(EventKind::graspSlip), 1) << "told once";
  EXPECT_LE(strongest, limit * 1.001) << "a hold that slips does not pull harder";
  EXPECT_GT(strongest, 0.9 * limit);
  EXPECT_EQ(count(EventKind::tissueTear), 0);
  EXPECT_EQ(count(EventKind::graspEnd), 1) << "pulled on, the tissue leaves the jaws";
  EXPECT_EQ(rig_->state.hand[0].grasp.structure, noStructure);
}

TEST_F(Grasping, TearsOverTheStatedForceWhenLocked) {
  grasp(button::lock);
  const double limit = model_->scene().hands[0].tearForce;
  double before = 0.0;
  for (int i = 0; i < 250 && count(EventKind::tissueTear) == 0; ++i) {
    const StepResult& result = step(hold_ + Vec3(0.0, 0.0, 2e-4 * i), 0.0, button::lock);
    if (count(EventKind::tissueTear) == 0) before = result.hand[0].graspForce;
  }
  ASSERT_EQ(count(EventKind::tissueTear), 1);
  EXPECT_EQ(count(EventKind::graspSlip), 0) << "a lock holds twice as hard";
  EXPECT_LE(before, limit);
  EXPECT_GT(before, 0.9 * limit);
  const auto tear =
      std::find_if(events_.begin(), events_.end(), [](const Event& e) { return e.kind == EventKind::tissueTear; });
  EXPECT_GT(tear->value, limit);
  EXPECT_EQ(rig_->state.hand[0].grasp.structure, noStructure);
  // Closed jaws do not take hold again.
  for (int i = 0; i < 50; ++i) step(hold_, 0.0, button::lock);
  EXPECT_EQ(count(EventKind::graspBegin), 1);
}

TEST_F(Grasping, ClosedJawsHoldNothing) {
  for (int i = 0; i < 80; ++i) step(Vec3(0.001, 0.002, std::max(0.04 - 0.001 * i, test::blockTop - 0.002)), 0.0);
  EXPECT_EQ(count(EventKind::graspBegin), 0) << "jaws grasp when they close, not when they are closed";
  EXPECT_GT(count(EventKind::contactBegin), 0);
}

TEST_F(Grasping, ARestoredHoldGoesOnWithTheSameBits) {
  grasp();
  const auto pull = [&](int i) { return Vec3(hold_ + Vec3(5e-5 * i, 0.0, 1.5e-4 * i)); };
  for (int i = 0; i < 15; ++i) step(pull(i), 0.0);
  const std::vector<std::byte> saved = saveState(rig_->state);
  test::Rig other(*model_);
  other.step(model_->scene().hands[0].home);  // a stepper that has seen something else
  ASSERT_TRUE(restoreState(*model_, saved, other.state));
  other.stepper.invalidate();
  for (int i = 15; i < 60; ++i) {
    step(pull(i), i < 45 ? 0.0 : 0.6);
    other.stepper.step(other.state, test::ticksAt(model_->scene(), pull(i), model_->scene().hands[1].home));
    if (i < 45) {
      ASSERT_EQ(digestOf(rig_->state).component, digestOf(other.state).component) << "step " << i;
    }
  }
  EXPECT_EQ(rig_->state.hand[0].grasp.structure, noStructure);
  EXPECT_EQ(other.state.hand[0].grasp.structure, 0U) << "its jaws stayed closed";
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// What a device may send: nothing, nonsense, too far away, another instrument.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Event> eventsOf(const StepResult& result, EventKind kind) {
  std::vector<Event> out;
  for (const Event& event : result.events) {
    if (event.kind == kind) out.push_back(event);
  }
  return out;
}

class InputsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(test::blockScene(300, 6)); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }
  static std::vector<TickSamples> ticks(const Vec3& left) {
    return test::ticksAt(model_->scene(), left, model_->scene().hands[1].home);
  }
  static inline std::unique_ptr<const Model> model_;
};

TEST_F(InputsTest, WhatIsNoMeasurementHoldsThePose) {
  struct Case {
    std::string what;
    std::function<void(InstrumentSample&)> spoil;
  };
  const std::vector<Case> cases{
      {"not valid", [](InstrumentSample& s) { s.valid = false; }},
      {"NaN position", [](InstrumentSample& s) { s.position[1] = nan; }},
      {"infinite position", [](InstrumentSample& s) { s.position[2] = -infinity; }},
      {"NaN orientation", [](InstrumentSample& s) { s.orientation.y() = nan; }},
      {"infinite orientation", [](InstrumentSample& s) { s.orientation.w() = infinity; }},
      {"zero quaternion", [](InstrumentSample& s) { s.orientation.coeffs().setZero(); }},
      {"NaN jaw", [](InstrumentSample& s) { s.jaw = nan; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    test::Rig rig(*model_);
    const Vec3 pressing(-0.005, 0.002, test::blockTop - 0.001);
    for (int i = 0; i < 20; ++i) rig.step(pressing);
    const HandState before = rig.state.hand[0];
    ASSERT_NE(before.touches.structures, 0U);
    std::vector<TickSamples> bad = ticks(Vec3(0.02, 0.02, 0.03));
    for (TickSamples& tick : bad) c.spoil(tick.hand[0]);
    for (int i = 0; i < 7; ++i) {
      const StepResult& result = rig.stepper.step(rig.state, bad);
      const std::vector<Event> invalid = eventsOf(result, EventKind::sampleInvalid);
      ASSERT_EQ(invalid.size(), i == 0 ? 1U : 0U) << "one event where measurements stop";
      if (i == 0) {
        EXPECT_EQ(invalid[0].hand, 0);
        EXPECT_EQ(invalid[0].step, 20U);
        EXPECT_EQ(invalid[0].position, before.input.position);
      }
      EXPECT_EQ(rig.state.hand[0].input.position, before.input.position);
      EXPECT_EQ(rig.state.hand[0].input.orientation.coeffs(), before.input.orientation.coeffs());
      EXPECT_FALSE(rig.state.hand[0].input.valid);
      EXPECT_TRUE(rig.state.hand[1].input.valid) << "the other hand goes on";
      EXPECT_NE(rig.state.hand[0].touches.structures, 0U) << "and so does the contact";
      ASSERT_TRUE(test::allFinite(rig.state));
      ASSERT_TRUE(test::allFinite(result));
    }
    const StepResult& back = rig.step(pressing);
    const std::vector<Event> valid = eventsOf(back, EventKind::sampleValid);
    ASSERT_EQ(valid.size(), 1U);
    EXPECT_EQ(valid[0].hand, 0);
    EXPECT_NEAR(valid[0].value, 0.07, 1e-12) << "seven steps without measurements";
    EXPECT_TRUE(rig.state.hand[0].input.valid);
  }
}

TEST_F(InputsTest, TheNewestMeasurementOfTheStepCounts) {
  test::Rig rig(*model_);
  std::vector<TickSamples> mixed = ticks(Vec3(-0.012, 0.0, 0.04));
  mixed[6].hand[0].position = Vec3(-0.01, 0.004, 0.038);
  for (std::size_t i = 7; i < mixed.size(); ++i) mixed[i].hand[0].valid = false;
  const StepResult& result = rig.stepper.step(rig.state, mixed);
  EXPECT_EQ(rig.state.hand[0].input.position, Vec3(-0.01, 0.004, 0.038));
  EXPECT_EQ(eventsOf(result, EventKind::sampleInvalid).size(), 1U) << "the step ended without measurements";
}

TEST_F(InputsTest, OutOfTheWorkspaceIsClampedWithOneEvent) {
  test::Rig rig(*model_);
  for (int i = 0; i < 5; ++i) {
    const StepResult& result = rig.step(Vec3(0.2, -0.03, 0.05));
    const std::vector<Event> out = eventsOf(result, EventKind::outOfWorkspace);
    ASSERT_EQ(out.size(), i == 0 ? 1U : 0U);
    if (i == 0) {
      EXPECT_EQ(out[0].hand, 0);
      EXPECT_NEAR(out[0].value, 0.05, 1e-12) << "distance outside";
    }
    EXPECT_LT((rig.state.hand[0].input.position - Vec3(0.15, -0.03, 0.05)).norm(), 1e-15);
    EXPECT_TRUE(rig.state.hand[0].input.valid) << "a sample outside is a measurement all the same";
  }
  EXPECT_TRUE(eventsOf(rig.step(Vec3(0.1, -0.03, 0.05)), EventKind::outOfWorkspace).empty());
  EXPECT_EQ(eventsOf(rig.step(Vec3(0.2, -0.03, 0.05)), EventKind::outOfWorkspace).size(), 1U) << "left a second time";
}

/// Numbers at the ends of double, poses in the port, on the far side of it, turned quaternions of any size.
TEST_F(InputsTest, ExtremeMeasurementsStayFinite) {
  const Vec3 port = model_->scene().hands[0].port;
  std::vector<InstrumentSample> extremes(9);
  extremes[0].position = Vec3::Constant(1e300);
  extremes[1].position = Vec3::Constant(-1e9);
  extremes[2].position = port;
  extremes[3].position = port + Vec3(0.0, 0.0, 1e-300);
  extremes[4].position = Vec3(port + Vec3(0.0, 0.0, 0.02));
  extremes[5].position = Vec3(-0.012, 0.0, -0.1);  // straight through the block
  extremes[6].position = Vec3(0.0, 0.0, 0.0);
  extremes[6].orientation = Quat(1e200, 1e200, -1e200, 0.0);
  extremes[7].position = Vec3(-0.1, -0.1, 0.0);
  extremes[7].jaw = -1e300;
  extremes[8].position = Vec3(5e-324, -5e-324, 5e-324);
  extremes[8].jaw = 1e300;
  test::Rig rig(*model_);
  for (int round = 0; round < 4; ++round) {
    for (std::size_t k = 0; k < extremes.size(); ++k) {
      std::vector<TickSamples> samples = ticks(Vec3::Zero());
      for (TickSamples& tick : samples) {
        tick.hand[0] = extremes[round % 2 == 0 ? k : extremes.size() - 1 - k];
        tick.camera.position = Vec3::Constant(nan);
        tick.camera.orientation.coeffs().setZero();
      }
      const StepResult& result = rig.stepper.step(rig.state, samples);
      ASSERT_TRUE(test::allFinite(rig.state)) << "round " << round << " sample " << k;
      ASSERT_TRUE(test::allFinite(result)) << "round " << round << " sample " << k;
      ASSERT_GE(rig.state.hand[0].instrument.jaw, 0.0);
      ASSERT_LE(rig.state.hand[0].instrument.jaw, 1.6);
      for (const HandState& hand : rig.state.hand) {
        ASSERT_NEAR(hand.input.orientation.norm(), 1.0, 1e-12);
        ASSERT_NEAR(hand.instrument.orientation.norm(), 1.0, 1e-12);
      }
    }
  }
  EXPECT_EQ(rig.state.camera.position, model_->scene().camera.position) << "a camera that is no measurement is held";
}

TEST_F(InputsTest, InstrumentExchangeIsAnEvent) {
  test::Rig rig(*model_);
  rig.step(model_->scene().hands[0].home);
  std::vector<TickSamples> samples = ticks(model_->scene().hands[0].home);
  for (TickSamples& tick : samples) tick.hand[0].instrument = InstrumentKind::clipApplier;
  const StepResult& first = rig.stepper.step(rig.state, samples);
  const std::vector<Event> exchange = eventsOf(first, EventKind::instrumentExchange);
  ASSERT_EQ(exchange.size(), 1U);
  EXPECT_EQ(exchange[0].hand, 0);
  EXPECT_EQ(exchange[0].subject, static_cast<std::uint16_t>(InstrumentKind::clipApplier));
  EXPECT_EQ(exchange[0].value, static_cast<double>(InstrumentKind::grasper));
  EXPECT_EQ(first.hand[0].instrument, InstrumentKind::clipApplier);
  EXPECT_TRUE(eventsOf(rig.stepper.step(rig.state, samples), EventKind::instrumentExchange).empty());
}

TEST_F(InputsTest, AnEmptyPortTouchesNothing) {
  test::Rig rig(*model_);
  std::vector<TickSamples> samples = ticks(Vec3(0.0, 0.0, test::blockTop - 0.004));
  for (TickSamples& tick : samples) tick.hand[0].instrument = InstrumentKind::none;
  for (int i = 0; i < 20; ++i) {
    const StepResult& result = rig.stepper.step(rig.state, samples);
    EXPECT_EQ(result.hand[0].touching, 0U);
    EXPECT_EQ(result.contact.rows, 0U);
    EXPECT_TRUE(result.hand[0].contactForce.isZero(0.0));
  }
}

}  // namespace
}  // namespace calot

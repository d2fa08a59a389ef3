// SPDX-License-Identifier: GPL-3.0-or-later
// The procedure as steps report it and the judge judges it: phases, critical view, errors; and the assistant's pull.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "sim/judgement/judge.h"
#include "tests/sim/scene/support/scenes.h"
#include "tests/support/message.h"

namespace calot {
namespace {

constexpr double height = 0.03;
constexpr std::size_t duct = 1;
constexpr std::size_t main_ = 2;

/// Two ducts side by side over a block, one to be divided, one to be spared.
SceneDescription twoDucts() {
  SceneDescription scene = test::blockScene(300, 6);
  scene.name = "two ducts";
  VesselDescription d;
  d.name = "duct";
  d.path = {Vec3(-0.04, -0.012, height), Vec3(0.04, -0.012, height)};
  d.radius = 0.002;
  d.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(d);
  d.name = "main";
  d.path = {Vec3(-0.04, 0.012, height), Vec3(0.04, 0.012, height)};
  scene.vessels.push_back(d);
  scene.procedure.specimen = "block";
  scene.procedure.divide = {{"duct", 2, 1, true}};
  scene.procedure.spare = {"main"};
  scene.hands[0].home = Vec3(0.0, 0.0, 0.06);
  scene.hands[1].home = Vec3(0.05, 0.0, 0.06);
  return scene;
}

class Procedure : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(twoDucts()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(model_);
    rig_ = std::make_unique<test::Rig>(*model_);
    judge_ = std::make_unique<Judge>(model_->scene());
  }
  const StepResult& step(const Vec3& tip, double jaw, InstrumentKind instrument, std::uint8_t buttons = 0) {
    TickSamples tick;
    tick.camera = model_->scene().camera;
    InstrumentSample& hand = tick.hand[0];
    hand.position = tip;
    Mat3 frame;  // jaws open across the ducts
    frame << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    hand.orientation = Quat(frame);
    hand.jaw = jaw;
    hand.instrument = instrument;
    hand.buttons = buttons;
    tick.hand[1].position = model_->scene().hands[1].home;
    const StepResult& result =
        rig_->stepper.step(rig_->state, std::vector<TickSamples>(model_->scene().ticksPerStep, tick));
    const Judgement& judgement = judge_->observe(result);
    events_.insert(events_.end(), judgement.events.begin(), judgement.events.end());
    EXPECT_EQ(rig_->stepper.digest(rig_->state), digestOf(rig_->state));
    return result;
  }
  void closeAt(InstrumentKind instrument, double x, double y) {
    const double below = instrument == InstrumentKind::clipApplier ? 0.0042 : 0.006;
    for (int i = 0; i <= 40; ++i) step(Vec3(x, y, 0.06 + (height - below - 0.06) * i / 40.0), 0.9, instrument);
    for (int i = 0; i <= 20; ++i) step(Vec3(x, y, height - below), 0.9 - 0.04 * i, instrument);
    for (int i = 0; i <= 20; ++i) step(Vec3(x, y, height - below), 0.1 + 0.04 * i, instrument);
    for (int i = 0; i <= 40; ++i)
      step(Vec3(x, y, height - below + (0.06 - height + below) * i / 40.0), 0.9, instrument);
  }
  [[nodiscard]] const Judgement& now() const { return judge_->judgement(); }
  [[nodiscard]] std::vector<Event> all(EventKind kind) const {
    std::vector<Event> found;
    std::copy_if(events_.begin(), events_.end(), std::back_inserter(found),
                 [&](const Event& e) { return e.kind == kind; });
    return found;
  }

  static inline std::unique_ptr<const Model> model_;
  std::unique_ptr<test::Rig> rig_;
  std::unique_ptr<Judge> judge_;
  std::vector<Event> events_;
};

TEST_F(Procedure, AsItShouldBe) {
  EXPECT_EQ(now().phase, Phase::clipping) << "there is no fat to be carved";
  for (const double x : {-0.024, -0.018, -0.006}) closeAt(InstrumentKind::clipApplier, x, -0.012);
  EXPECT_TRUE(now().criticalViewFrozen);
  EXPECT_EQ(now().triangleCleared, 2);
  EXPECT_EQ(now().lowerThirdFreed, 2);
  EXPECT_EQ(now().twoStructures, 2);
  closeAt(InstrumentKind::scissors, -0.012, -0.012);
  ASSERT_EQ(all(EventKind::vesselCut).size(), 1U);
  EXPECT_TRUE(all(EventKind::tooFewClips).empty());
  EXPECT_EQ(now().phase, Phase::done) << "nothing else holds the specimen";
  EXPECT_EQ(now().errors(), 0U);
  const std::vector<Event> phases = all(EventKind::phaseBegin);
  ASSERT_FALSE(phases.empty());
  EXPECT_EQ(phases.back().subject, static_cast<std::uint16_t>(Phase::done));
}

TEST_F(Procedure, AClipTooFewIsAnError) {
  for (const double x : {-0.020, -0.006}) closeAt(InstrumentKind::clipApplier, x, -0.012);
  closeAt(InstrumentKind::scissors, -0.013, -0.012);
  ASSERT_EQ(all(EventKind::tooFewClips).size(), 1U);
  EXPECT_EQ(all(EventKind::tooFewClips)[0].value, 1.0);
  EXPECT_EQ(all(EventKind::tooFewClips)[0].subject, duct);
  EXPECT_EQ(now().errors(), 1U);
}

TEST_F(Procedure, WhatIsToBeSparedIsACriticalError) {
  closeAt(InstrumentKind::clipApplier, -0.02, 0.012);
  closeAt(InstrumentKind::scissors, -0.01, 0.012);
  const std::vector<Event> critical = all(EventKind::criticalError);
  ASSERT_EQ(critical.size(), 2U);
  EXPECT_EQ(critical[0].subject, main_);
  EXPECT_EQ(critical[0].value, static_cast<double>(EventKind::clipSet));
  EXPECT_EQ(critical[1].value, static_cast<double>(EventKind::vesselCut));
  EXPECT_EQ(now().errors(Severity::critical), 2U);
  step(Vec3(0.0, 0.0, 0.06), 0.9, InstrumentKind::scissors);
  EXPECT_EQ(now().errors(Severity::critical), 2U);
}

TEST_F(Procedure, AVesselThatIsCutBeforeTheFirstClipIsNotSeenAnyMore) {
  closeAt(InstrumentKind::scissors, -0.012, -0.012);
  EXPECT_EQ(now().twoStructures, 0);
  EXPECT_FALSE(now().criticalViewFrozen);
  closeAt(InstrumentKind::clipApplier, 0.01, -0.012);
  EXPECT_TRUE(now().criticalViewFrozen);
  EXPECT_EQ(now().twoStructures, 0);
}

/// A block that an assistant pulls upwards at one end, by this displacement (m).
SceneDescription pulledBlock(double displacement) {
  SceneDescription scene = test::blockScene(300, 6);
  RetractionDescription pull;
  pull.organ = "block";
  pull.centre = Vec3(0.03, 0.0, test::blockTop);
  pull.radius = 0.012;
  pull.displacement = Vec3(0.0, 0.0, displacement);
  scene.retraction.push_back(pull);
  return scene;
}

TEST(Retraction, PullsWhatLiesInItsSphereAndThenSleeps) {
  SceneDescription scene = pulledBlock(0.004);
  scene.retraction[0].start = 0.2;
  scene.retraction[0].duration = 0.5;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  const Vec3 home = scene.hands[0].home;
  for (int i = 0; i < 19; ++i) EXPECT_TRUE(rig.step(home).organ[0].asleep);
  double largest = 0.0;
  for (int i = 0; i < 600; ++i) {
    const StepResult& result = rig.step(home);
    largest = std::max(largest, result.organ[0].maxDisplacement);
    EXPECT_EQ(result.misses, 0U);
  }
  EXPECT_GT(largest, 0.001);
  EXPECT_LT(largest, 0.0045);
  EXPECT_TRUE(rig.step(home).organ[0].asleep) << "held still, it is at rest";
}

/// Presses a button for one tick of a step, which other ticks have not.
std::vector<Event> ask(test::Rig& rig, const SceneDescription& scene, std::uint8_t button, std::size_t tick) {
  std::vector<TickSamples> samples(scene.ticksPerStep);
  for (TickSamples& each : samples) {
    each.camera = scene.camera;
    for (std::size_t h = 0; h < handCount; ++h) {
      each.hand[h].position = scene.hands[h].home;
      each.hand[h].instrument = scene.hands[h].instrument;
    }
  }
  samples[tick].hand[1].buttons = button;
  return rig.stepper.step(rig.state, samples).events;
}

TEST(Retraction, IsAskedForByAButtonAndTold) {
  SceneDescription scene = pulledBlock(0.002);
  scene.retraction[0].duration = 0.2;
  scene.retraction[0].most = 2.0;
  scene.retraction.push_back(scene.retraction[0]);  // another one, which cannot be asked for
  scene.retraction[0].stage = 1.0;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  const Vec3 home = scene.hands[0].home;
  double before = 0.0;
  for (int i = 0; i < 700; ++i) before = rig.step(home).organ[0].maxDisplacement;
  EXPECT_TRUE(rig.step(home).organ[0].asleep);

  const std::vector<Event> told = ask(rig, scene, button::retractMore, 4);
  ASSERT_EQ(told.size(), 1U) << "once, of one tick among ten, by the one that can be asked";
  EXPECT_EQ(told[0].kind, EventKind::retractionMore);
  EXPECT_EQ(told[0].hand, 1);
  EXPECT_EQ(told[0].subject, 0);
  EXPECT_DOUBLE_EQ(told[0].value, 0.004);
  EXPECT_EQ(told[0].position, scene.retraction[0].centre);
  double after = 0.0;
  for (int i = 0; i < 100; ++i) after = rig.step(home).organ[0].maxDisplacement;
  EXPECT_GT(after, 1.3 * before) << "it woke and was pulled farther";

  const std::vector<Event> less = ask(rig, scene, button::retractLess, 9);
  ASSERT_EQ(less.size(), 1U);
  EXPECT_EQ(less[0].kind, EventKind::retractionLess);
  EXPECT_DOUBLE_EQ(less[0].value, 0.002);
  EXPECT_TRUE(ask(rig, scene, 0, 0).empty());
}

/// Held down, a button asks once.
TEST(Retraction, AButtonThatStaysDownAsksOnce) {
  SceneDescription scene = pulledBlock(0.002);
  scene.retraction[0].stage = 0.25;
  scene.retraction[0].most = 2.0;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  std::size_t asked = 0;
  for (int i = 0; i < 20; ++i) {
    TickSamples tick;
    tick.camera = scene.camera;
    tick.hand[0].position = scene.hands[0].home;
    tick.hand[1].position = scene.hands[1].home;
    tick.hand[0].buttons = button::retractMore;
    tick.hand[1].valid = false;
    tick.hand[1].buttons = button::retractLess;  // of a hand that nothing measured
    const std::vector<TickSamples> samples(scene.ticksPerStep, tick);
    for (const Event& e : rig.stepper.step(rig.state, samples).events) {
      EXPECT_NE(e.kind, EventKind::retractionLess);
      asked += e.kind == EventKind::retractionMore ? 1 : 0;
    }
  }
  EXPECT_EQ(asked, 1U);
  EXPECT_EQ(rig.state.retraction.goal[0], 1.25);
}

TEST(ProcedureModelBuild, SaysWhatIsWrong) {
  const auto error = [](auto&& change) {
    SceneDescription scene = twoDucts();
    change(scene);
    return Model::build(std::move(scene)).error;
  };
  expectNames(error([](SceneDescription& s) { s.procedure.specimen = "spleen"; }), {"procedure: ", "'spleen'"});
  expectNames(error([](SceneDescription& s) { s.procedure.bed = "bed"; }), {"procedure: ", "'bed'"});
  expectNames(error([](SceneDescription& s) { s.procedure.spare = {"block"}; }), {"procedure: ", "'block'"});
  expectNames(error([](SceneDescription& s) {
                s.retraction.push_back({"block", Vec3::Zero(), 1e-6});
              }),
              {"retraction: ", "'block'"});
}

}  // namespace
}  // namespace calot

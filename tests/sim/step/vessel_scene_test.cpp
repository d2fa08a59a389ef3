// SPDX-License-Identifier: GPL-3.0-or-later
// Ducts in whole steps: touched, held, pulled until they tear, clipped, cut and burned through.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "sim/judgement/judge.h"
#include "sim/vessel/beam_state.h"
#include "tests/sim/scene/support/scenes.h"
#include "tests/support/message.h"

namespace calot::vessel_scene_test {
namespace {

constexpr double height = 0.03;  ///< of the duct's centre line (m)
constexpr double radius = 0.002;
constexpr std::size_t duct = 1;    // structures: the block, then
constexpr std::size_t branch = 2;  // vessels

/// A duct over the block, held at its ends 80 mm apart, and a thin branch that grows out of its middle into the block.
SceneDescription ductScene() {
  SceneDescription scene = test::blockScene(300, 6);
  scene.name = "duct over a block";
  VesselDescription d;
  d.name = "duct";
  d.appearance = "duct";
  d.path = {Vec3(-0.04, 0.0, height), Vec3(0.0, 0.0, height), Vec3(0.04, 0.0, height)};
  d.radius = radius;
  d.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(d);
  VesselDescription b = d;
  b.name = "branch";
  b.radius = 0.001;
  b.path = {Vec3(0.0, 0.0, height), Vec3(0.0, 0.008, 0.025), Vec3(0.0, 0.012, test::blockTop - 0.001)};
  b.elements = 20;
  b.start = {VesselEndDescription::Kind::vessel, "duct"};
  b.end = {VesselEndDescription::Kind::organ, "block"};
  scene.vessels.push_back(b);
  scene.hands[0].home = Vec3(-0.02, 0.0, 0.06);
  scene.hands[1].home = Vec3(0.05, 0.0, 0.06);
  scene.hands[0].slipForce = scene.hands[0].tearForce = 50.0;
  return scene;
}

/// The left hand with jaws that open in the plane across the duct.
struct Act {
  Vec3 tip = Vec3(-0.02, 0.0, 0.06);
  double jaw = 0.0;
  InstrumentKind instrument = InstrumentKind::grasper;
  std::uint8_t buttons = 0;
};

class VesselScene : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(ductScene()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(model_);
    rig_ = std::make_unique<test::Rig>(*model_);
    judge_ = std::make_unique<Judge>(model_->scene());
    act_ = {};
  }

  const StepResult& step(const Act& act) {
    TickSamples tick;
    tick.camera = model_->scene().camera;
    InstrumentSample& hand = tick.hand[0];
    hand.position = act.tip;
    Mat3 frame;
    frame << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    hand.orientation = Quat(frame);
    hand.jaw = act.jaw;
    hand.instrument = act.instrument;
    hand.buttons = act.buttons;
    tick.hand[1].position = model_->scene().hands[1].home;
    const StepResult& result =
        rig_->stepper.step(rig_->state, std::vector<TickSamples>(model_->scene().ticksPerStep, tick));
    const Judgement& judgement = judge_->observe(result);
    events_.insert(events_.end(), judgement.events.begin(), judgement.events.end());
    hardest_ = std::max(hardest_, result.hand[0].structureForce[duct]);
    EXPECT_EQ(rig_->stepper.digest(rig_->state), digestOf(rig_->state));
    return result;
  }
  /// Moves there in a straight line.
  const StepResult& go(const Act& to, int steps) {
    const Act from = act_;
    for (int i = 1; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      act_ = to;
      act_.tip = from.tip + s * (to.tip - from.tip);
      act_.jaw = from.jaw + s * (to.jaw - from.jaw);
      if (i < steps) step(act_);
    }
    return step(act_);
  }
  [[nodiscard]] int count(EventKind kind) const {
    return static_cast<int>(
        std::count_if(events_.begin(), events_.end(), [&](const Event& e) { return e.kind == kind; }));
  }
  [[nodiscard]] const Event* last(EventKind kind) const {
    const Event* found = nullptr;
    for (const Event& e : events_) {
      if (e.kind == kind) found = &e;
    }
    return found;
  }
  /// Opens, comes down around the duct at x, closes, opens, goes up again. The jaws stay open: a clip applier that
  /// closes on nothing drops its clip.
  void closeAt(InstrumentKind instrument, double x, double below) {
    go({Vec3(x, 0.0, 0.06), 0.9, instrument, 0}, 40);
    go({Vec3(x, 0.0, height - below), 0.9, instrument, 0}, 40);
    go({Vec3(x, 0.0, height - below), 0.1, instrument, 0}, 20);
    go({Vec3(x, 0.0, height - below), 0.9, instrument, 0}, 20);
    go({Vec3(x, 0.0, 0.06), 0.9, instrument, 0}, 40);
  }
  [[nodiscard]] const BeamState& vessels() const { return rig_->state.vessel[0]; }

  static inline std::unique_ptr<const Model> model_;
  std::unique_ptr<test::Rig> rig_;
  std::unique_ptr<Judge> judge_;
  Act act_;
  std::vector<Event> events_;
  double hardest_ = 0.0;  ///< of the instrument on the duct so far (N)
};

TEST_F(VesselScene, StructuresAndBodies) {
  ASSERT_EQ(model_->structures().size(), 3U);
  EXPECT_EQ(model_->bodies(), 2U) << "vessels that grow out of one another are solved as one";
  EXPECT_EQ(model_->structures()[duct].name, "duct");
  EXPECT_EQ(model_->structures()[branch].body, model_->structures()[duct].body);
  EXPECT_FALSE(model_->ties().empty()) << "the branch is grown to the block";
}

TEST_F(VesselScene, RestIsRestAndSleeps) {
  for (int i = 0; i < 60; ++i) {
    const StepResult& result = step({});
    EXPECT_TRUE(result.vessel[0].asleep);
    EXPECT_EQ(result.vessel[0].maxDisplacement, 0.0);
  }
}

/// Pressed down in its middle, a duct gives way, pushes back, and goes back to where it was; the branch hands the pull
/// on to the block.
TEST_F(VesselScene, GivesWayAndComesBack) {
  const double top = height + radius;
  go({Vec3(-0.01, 0.0, top + 0.001), 0.0, InstrumentKind::grasper, 0}, 60);
  const StepResult& pressed = go({Vec3(-0.01, 0.0, top - 0.004), 0.0, InstrumentKind::grasper, 0}, 60);
  EXPECT_NE(pressed.hand[0].touching & (1U << duct), 0U);
  EXPECT_EQ(pressed.hand[0].touching & (1U << branch), 0U);
  EXPECT_GT(pressed.hand[0].structureForce[duct], 0.005);
  EXPECT_GT(pressed.vessel[0].maxDisplacement, 0.001);
  EXPECT_GT(pressed.vessel[0].maxStrain, 0.0);
  EXPECT_LT(pressed.contact.maxDepth, 2e-4);
  EXPECT_EQ(pressed.misses, 0U);
  EXPECT_GT(pressed.organ[0].maxDisplacement, 1e-6);
  go({Vec3(-0.01, 0.0, 0.06), 0.0, InstrumentKind::grasper, 0}, 60);
  for (int i = 0; i < 600; ++i) step(act_);
  EXPECT_TRUE(step(act_).vessel[0].asleep);
  EXPECT_LT(vessels().maxDisplacement, 2e-4);
  EXPECT_EQ(count(EventKind::contactBegin), count(EventKind::contactEnd));
}

/// The pull of the jaws is what the duct's tension says: on a duct that is lifted by its middle, both halves pull.
TEST_F(VesselScene, HeldAndLiftedUntilItTears) {
  go({Vec3(-0.01, 0.0, height - 0.002), 0.8, InstrumentKind::grasper, button::lock}, 60);
  go({Vec3(-0.01, 0.0, height - 0.002), 0.05, InstrumentKind::grasper, button::lock}, 40);
  ASSERT_EQ(rig_->state.hand[0].grasp.structure, duct);
  const StepResult& lifted = go({Vec3(-0.01, 0.0, height + 0.013), 0.05, InstrumentKind::grasper, button::lock}, 200);
  ASSERT_EQ(lifted.hand[0].grasping, 1U << duct);
  for (int i = 0; i < 200; ++i) step(act_);
  const StepResult& still = step(act_);
  EXPECT_GT(still.vessel[0].maxTension, 0.02);
  EXPECT_GT(still.hand[0].graspForce, 0.5 * still.vessel[0].maxTension);
  EXPECT_LT(still.hand[0].graspForce, 3.0 * still.vessel[0].maxTension);
  for (int i = 0; i < 4; ++i) {
    go({act_.tip + Vec3(0.0, 0.0, 0.015), 0.05, InstrumentKind::grasper, button::lock}, 100);
    if (count(EventKind::vesselTorn) > 0) break;
  }
  ASSERT_GE(count(EventKind::vesselTorn), 1);
  EXPECT_EQ(last(EventKind::vesselTorn)->subject, duct);
  EXPECT_GT(last(EventKind::vesselTorn)->value, model_->scene().vessels[0].ultimateStrain);
  for (int i = 0; i < 300; ++i) step(act_);
  EXPECT_GE(step(act_).vessel[0].partings, 1U);
}

TEST_F(VesselScene, AClipCloses) {
  closeAt(InstrumentKind::clipApplier, -0.015, 0.0042);
  ASSERT_EQ(count(EventKind::clipSet), 1);
  EXPECT_EQ(last(EventKind::clipSet)->subject, duct);
  EXPECT_NEAR(last(EventKind::clipSet)->position[0], -0.015, 0.0015);
  EXPECT_EQ(count(EventKind::clipHalfOn) + count(EventKind::clipDropped) + count(EventKind::clipOnClip), 0);
  EXPECT_EQ(rig_->state.hand[0].instrument.clips, model_->scene().hands[0].clips - 1);
  ASSERT_EQ(vessels().clips(), 1U);
  EXPECT_TRUE(closes(vessels(), 0));
  EXPECT_EQ(step(act_).vessel[0].clips, 1U);
  EXPECT_EQ(step(act_).vessel[1].clips, 0U);
}

/// Jaws that go on closing about a clip crush it; they do not throw the duct about, however deep it lies between them.
TEST_F(VesselScene, JawsAboutAClipDoNotPushTheDuct) {
  double x = -0.022;
  for (const double below : {0.003, 0.0042, 0.0058, 0.0062}) {
    go({Vec3(x, 0.0, 0.06), 0.9, InstrumentKind::clipApplier, 0}, 40);
    go({Vec3(x, 0.0, height - below), 0.9, InstrumentKind::clipApplier, 0}, 40);
    go({Vec3(x, 0.0, height - below), 0.26, InstrumentKind::clipApplier, 0}, 20);
    const int before = count(EventKind::clipSet);
    hardest_ = 0.0;
    go({Vec3(x, 0.0, height - below), 0.1, InstrumentKind::clipApplier, 0}, 10);
    ASSERT_EQ(count(EventKind::clipSet), before + 1) << below;
    const StepResult& closed = step(act_);
    EXPECT_LT(hardest_, 0.1) << below << " m between the jaws";
    EXPECT_LT(closed.vessel[0].maxStrain, 0.05) << below;
    go({Vec3(x, 0.0, height - below), 0.9, InstrumentKind::clipApplier, 0}, 20);
    EXPECT_LT(hardest_, 0.1) << below << " m, as they open";
    x += 0.005;
  }
}

/// What should not be done can be done, and is told: half on, on another clip, too near, on nothing.
TEST_F(VesselScene, BadClipsAreTold) {
  closeAt(InstrumentKind::clipApplier, -0.015, 0.0042);
  closeAt(InstrumentKind::clipApplier, -0.0155, 0.0042);
  EXPECT_EQ(count(EventKind::clipOnClip), 1);
  closeAt(InstrumentKind::clipApplier, -0.022, 0.001);
  EXPECT_EQ(count(EventKind::clipHalfOn), 1);
  closeAt(InstrumentKind::clipApplier, -0.0015, 0.0042);
  EXPECT_EQ(count(EventKind::clipTooNear), 1) << "the branch is there";
  closeAt(InstrumentKind::clipApplier, -0.03, -0.02);
  EXPECT_EQ(count(EventKind::clipDropped), 1);
  EXPECT_EQ(rig_->state.hand[0].instrument.clips, model_->scene().hands[0].clips - 5);
}

TEST_F(VesselScene, AnEmptyApplierSetsNothing) {
  rig_->state.hand[0].instrument.clips = 0;
  closeAt(InstrumentKind::clipApplier, -0.015, 0.0042);
  EXPECT_EQ(count(EventKind::clipSet) + count(EventKind::clipDropped), 0);
  EXPECT_EQ(rig_->state.hand[0].instrument.clips, 0U);
}

TEST_F(VesselScene, ACutWithoutClipsOpensBothSides) {
  closeAt(InstrumentKind::scissors, -0.015, 0.006);
  ASSERT_EQ(count(EventKind::vesselCut), 1);
  EXPECT_EQ(last(EventKind::vesselCut)->subject, duct);
  EXPECT_NEAR(last(EventKind::vesselCut)->value, 0.025, 0.0015);
  ASSERT_EQ(count(EventKind::cutOpen), 1);
  EXPECT_EQ(last(EventKind::cutOpen)->value, 3.0);
  EXPECT_EQ(step(act_).vessel[0].partings, 1U);
  // Both stumps can still be touched, each for itself.
  for (const double x : {-0.02, -0.008}) {
    go({Vec3(x, 0.0, 0.05), 0.0, InstrumentKind::grasper, 0}, 60);
    const StepResult& pressed = go({Vec3(x, 0.0, height - 0.002), 0.0, InstrumentKind::grasper, 0}, 60);
    EXPECT_NE(pressed.hand[0].touching & (1U << duct), 0U) << x;
    go({Vec3(x, 0.0, 0.05), 0.0, InstrumentKind::grasper, 0}, 60);
  }
}

TEST_F(VesselScene, ACutBetweenClipsOpensNothing) {
  closeAt(InstrumentKind::clipApplier, -0.022, 0.0042);
  closeAt(InstrumentKind::clipApplier, -0.010, 0.0042);
  closeAt(InstrumentKind::scissors, -0.016, 0.006);
  ASSERT_EQ(count(EventKind::clipSet), 2);
  ASSERT_EQ(count(EventKind::vesselCut), 1);
  EXPECT_EQ(count(EventKind::cutOpen), 0);
  EXPECT_EQ(count(EventKind::cutThroughClip), 0);
}

TEST_F(VesselScene, ScissorsThatCloseBesideItCutNothing) {
  closeAt(InstrumentKind::scissors, -0.015, -0.01);
  EXPECT_EQ(count(EventKind::vesselCut), 0);
}

/// The hook parts a duct after its time of touch, makes smoke of what power times time is, and tells when it touches
/// nothing.
TEST_F(VesselScene, TheHookBurnsThrough) {
  const std::uint8_t on = button::coagulatePedal;
  const StepResult& above = go({Vec3(-0.015, 0.0, 0.06), 0.0, InstrumentKind::hook, on}, 40);
  EXPECT_EQ(above.hand[0].cautery, Cautery::withoutContact);
  go({Vec3(-0.015, 0.0, height + radius + 0.001), 0.0, InstrumentKind::hook, 0}, 60);
  EXPECT_EQ(count(EventKind::smoke), 0);
  const StepResult& burning = go({Vec3(-0.015, 0.0, height + radius - 0.0015), 0.0, InstrumentKind::hook, on}, 30);
  EXPECT_EQ(burning.hand[0].cautery, Cautery::onTissue);
  EXPECT_GT(burning.vessel[0].charred, 0.0);
  const std::uint64_t from = rig_->state.clock.step;
  while (count(EventKind::vesselBurned) == 0 && rig_->state.clock.step < from + 400) step(act_);
  ASSERT_EQ(count(EventKind::vesselBurned), 1);
  EXPECT_EQ(last(EventKind::vesselBurned)->subject, duct);
  EXPECT_EQ(last(EventKind::cutOpen)->value, 3.0);
  go({Vec3(-0.015, 0.0, 0.06), 0.0, InstrumentKind::hook, 0}, 30);
  double energy = 0.0;
  for (const Event& e : events_) {
    if (e.kind == EventKind::smoke && e.subject == duct) energy += e.value;
  }
  const double least = model_->scene().vessels[0].burnThrough * model_->scene().cautery.power;
  EXPECT_GT(energy, 0.99 * least);
}

/// Saved and restored in the middle of all that, the run goes on with the same bits.
TEST_F(VesselScene, RestoredRunsGoOnAlike) {
  closeAt(InstrumentKind::clipApplier, -0.022, 0.0042);
  closeAt(InstrumentKind::scissors, -0.012, 0.006);
  go({Vec3(-0.02, 0.0, height), 0.0, InstrumentKind::grasper, 0}, 60);
  const std::vector<std::byte> bytes = saveState(rig_->state);
  test::Rig other(*model_);
  ASSERT_TRUE(restoreState(*model_, bytes, other.state));
  std::vector<TickSamples> ticks;
  for (int i = 0; i < 60; ++i) {
    act_.tip[2] -= 1e-4;
    step(act_);
    TickSamples tick;
    tick.camera = model_->scene().camera;
    tick.hand[0].position = act_.tip;
    Mat3 frame;
    frame << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    tick.hand[0].orientation = Quat(frame);
    tick.hand[1].position = model_->scene().hands[1].home;
    other.stepper.step(other.state, std::vector<TickSamples>(model_->scene().ticksPerStep, tick));
    ASSERT_EQ(other.stepper.digest(other.state), rig_->stepper.digest(rig_->state)) << "step " << i;
  }
}

TEST(VesselModel, SaysWhatIsWrong) {
  const auto error = [](auto&& change) {
    SceneDescription scene = ductScene();
    change(scene);
    return Model::build(std::move(scene)).error;
  };
  expectNames(error([](SceneDescription& s) { s.vessels[1].start.to = "vein"; }), {"'branch': ", "'vein'"});
  expectNames(error([](SceneDescription& s) { s.vessels[1].end.to = "spleen"; }), {"'branch': ", "'spleen'"});
  expectNames(error([](SceneDescription& s) { s.vessels[0].path[1] = s.vessels[0].path[0]; }), {"'duct': ", "path"});
  EXPECT_FALSE(error([](SceneDescription& s) { s.vessels[0].wall = 0.0; }).empty());
}

}  // namespace
}  // namespace calot::vessel_scene_test

// SPDX-License-Identifier: GPL-3.0-or-later
// Fat in whole steps: on a block and around a duct, pressed, held and carved.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/sim/scene/support/scenes.h"
#include "tests/support/message.h"

namespace calot::fat_scene_test {
namespace {

constexpr double fatTop = test::blockTop + 0.010;
constexpr std::size_t fatStructure = 2;  // the block, a duct, then fat

/// A pad of fat on the block with a duct in it, held at the duct's ends.
SceneDescription padScene() {
  SceneDescription scene = test::blockScene(300, 6);
  scene.name = "fat on a block";
  VesselDescription duct;
  duct.name = "duct";
  duct.path = {Vec3(-0.025, 0.0, test::blockTop + 0.005), Vec3(0.025, 0.0, test::blockTop + 0.005)};
  duct.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  duct.start.kind = duct.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(duct);
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(-0.012, -0.010, test::blockTop + 0.0002), Vec3(0.012, 0.010, fatTop), {8, 8, 4});
  fat.cellSize = 0.001;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}, {"duct", 0.001, 2e7, 2e5}};
  fat.triangle = {Vec3(0.0, -0.02, test::blockTop + 0.005), Vec3(0.04, 0.0, test::blockTop + 0.005),
                  Vec3(0.0, 0.02, test::blockTop + 0.005)};
  fat.triangleDepth = 0.02;
  scene.fat.push_back(fat);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.06);
  scene.hands[1].home = Vec3(0.04, 0.0, 0.06);
  scene.hands[0].slipForce = scene.hands[0].tearForce = 50.0;
  return scene;
}

struct Act {
  Vec3 tip = Vec3(0.0, 0.0, 0.06);
  double jaw = 0.0;
  InstrumentKind instrument = InstrumentKind::hook;
  std::uint8_t buttons = 0;
};

std::vector<TickSamples> ticksOf(const SceneDescription& scene, const Act& act) {
  TickSamples tick;
  tick.camera = scene.camera;
  InstrumentSample& hand = tick.hand[0];
  hand.position = act.tip;
  hand.jaw = act.jaw;
  hand.instrument = act.instrument;
  hand.buttons = act.buttons;
  tick.hand[1].position = scene.hands[1].home;
  return std::vector<TickSamples>(scene.ticksPerStep, tick);
}

class FatScene : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(padScene()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(model_);
    rig_ = std::make_unique<test::Rig>(*model_);
  }
  const StepResult& step(const Act& act) {
    const StepResult& result = rig_->stepper.step(rig_->state, ticksOf(model_->scene(), act));
    carved_ += result.fat[0].carved;
    for (const Event& e : result.events) events_.push_back(e);
    EXPECT_EQ(rig_->stepper.digest(rig_->state), digestOf(rig_->state));
    return result;
  }
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
  /// One groove along x, `deep` below the top.
  void groove(double y, double deep) {
    go({Vec3(-0.016, y, fatTop + 0.004), 0.0, InstrumentKind::hook, 0}, 60);
    go({Vec3(-0.016, y, fatTop - deep), 0.0, InstrumentKind::hook, 0}, 20);
    go({Vec3(0.016, y, fatTop - deep), 0.0, InstrumentKind::hook, button::cutPedal}, 200);
    go({Vec3(0.016, y, fatTop + 0.004), 0.0, InstrumentKind::hook, 0}, 20);
  }

  static inline std::unique_ptr<const Model> model_;
  std::unique_ptr<test::Rig> rig_;
  Act act_;
  double carved_ = 0.0;
  std::vector<Event> events_;
};

TEST_F(FatScene, RestIsRestAndSleeps) {
  for (int i = 0; i < 30; ++i) {
    const StepResult& result = step({});
    EXPECT_TRUE(result.fat[0].asleep);
    EXPECT_NEAR(result.fat[0].volume, 0.024 * 0.020 * 0.0098, 0.02 * 0.024 * 0.020 * 0.0098);
    EXPECT_NEAR(result.fat[0].toClear, 0.5 * result.fat[0].volume, 0.05 * result.fat[0].volume);
    EXPECT_EQ(result.fat[0].maxDisplacement, 0.0);
  }
  EXPECT_EQ(model_->structures()[fatStructure].kind, tissueId<FatTissue>);
}

/// Pressed, it gives way, pushes back, carries the block with it; let go, it comes back.
TEST_F(FatScene, GivesWayAndComesBack) {
  go({Vec3(0.0, 0.005, fatTop + 0.001), 0.0, InstrumentKind::grasper, 0}, 60);
  const StepResult& pressed = go({Vec3(0.0, 0.005, fatTop - 0.003), 0.0, InstrumentKind::grasper, 0}, 60);
  EXPECT_EQ(pressed.hand[0].touching, 1U << fatStructure);
  EXPECT_GT(pressed.hand[0].structureForce[fatStructure], 0.002);
  EXPECT_GT(pressed.fat[0].maxDisplacement, 0.0005);
  EXPECT_GT(pressed.organ[0].maxDisplacement, 1e-6);
  EXPECT_LT(pressed.contact.maxDepth, 2e-4);
  EXPECT_EQ(pressed.misses, 0U);
  go({Vec3(0.0, 0.005, 0.06), 0.0, InstrumentKind::grasper, 0}, 60);
  for (int i = 0; i < 500; ++i) step(act_);
  const StepResult& after = step(act_);
  EXPECT_TRUE(after.fat[0].asleep);
  EXPECT_LT(after.fat[0].maxDisplacement, 1e-4);
  EXPECT_EQ(carved_, 0.0);
}

/// The current takes fat off along its way: the volume is missed from the whole, from the region that it was in, and
/// makes smoke.
TEST_F(FatScene, TheHookCarves) {
  const double before = step({}).fat[0].volume;
  groove(0.004, 0.002);
  const StepResult& after = step(act_);
  EXPECT_GT(carved_, 24e-9);
  EXPECT_LT(carved_, 0.1 * before);
  EXPECT_NEAR(before - after.fat[0].volume, carved_, 1e-6 * carved_);
  EXPECT_LT(after.fat[0].toClear, 0.5 * before - 0.3 * carved_);
  const bool smoke = std::any_of(events_.begin(), events_.end(), [](const Event& e) {
    return e.kind == EventKind::smoke && e.subject == fatStructure && e.value > 0.0;
  });
  EXPECT_TRUE(smoke);
  // Without current it takes nothing.
  const double left = after.fat[0].volume;
  carved_ = 0.0;
  go({Vec3(0.0, -0.005, fatTop + 0.002), 0.0, InstrumentKind::hook, 0}, 40);
  const StepResult& touched = go({Vec3(0.0, -0.005, fatTop - 0.001), 0.0, InstrumentKind::hook, 0}, 40);
  EXPECT_NE(touched.hand[0].touching & (1U << fatStructure), 0U);
  EXPECT_EQ(touched.fat[0].volume, left);
}

/// Groove by groove down to the duct: it is laid bare, and can be touched then.
TEST_F(FatScene, TheDuctIsLaidBare) {
  go({Vec3(0.0, 0.0, fatTop + 0.003), 0.0, InstrumentKind::grasper, 0}, 40);
  EXPECT_EQ(go({Vec3(0.0, 0.0, fatTop - 0.001), 0.0, InstrumentKind::grasper, 0}, 40).hand[0].touching & 2U, 0U);
  for (const double deep : {0.0015, 0.003}) {
    for (const double y : {-0.002, 0.0, 0.002}) groove(y, deep);
  }
  go({Vec3(0.0, 0.0, fatTop + 0.003), 0.0, InstrumentKind::grasper, 0}, 40);
  const StepResult& touched = go({Vec3(0.0, 0.0, fatTop - 0.0045), 0.0, InstrumentKind::grasper, 0}, 60);
  EXPECT_NE(touched.hand[0].touching & 2U, 0U);
}

TEST_F(FatScene, HeldFatFollowsAndIsLetGoWhereItIsBurned) {
  go({Vec3(0.0, 0.005, fatTop - 0.001), 0.8, InstrumentKind::grasper, button::lock}, 60);
  go({Vec3(0.0, 0.005, fatTop - 0.001), 0.0, InstrumentKind::grasper, button::lock}, 40);
  ASSERT_EQ(rig_->state.hand[0].grasp.structure, fatStructure);
  const StepResult& lifted = go({Vec3(0.0, 0.005, fatTop + 0.004), 0.0, InstrumentKind::grasper, button::lock}, 60);
  EXPECT_EQ(lifted.hand[0].grasping, 1U << fatStructure);
  EXPECT_GT(lifted.hand[0].graspForce, 0.001);
  EXPECT_GT(lifted.fat[0].maxDisplacement, 0.002);
}

/// Two steppers over one State, one of them restored in mid-stroke, give the same bits.
TEST_F(FatScene, RestoredRunsGoOnAlike) {
  groove(0.004, 0.002);
  go({Vec3(-0.016, -0.003, fatTop - 0.0015), 0.0, InstrumentKind::hook, 0}, 40);
  go({Vec3(0.0, -0.003, fatTop - 0.0015), 0.0, InstrumentKind::hook, button::cutPedal}, 60);
  const std::vector<std::byte> bytes = saveState(rig_->state);
  test::Rig other(*model_);
  ASSERT_TRUE(restoreState(*model_, bytes, other.state));
  for (int i = 0; i < 60; ++i) {
    act_.tip[0] += 2e-4;
    step(act_);
    other.stepper.step(other.state, ticksOf(model_->scene(), act_));
    ASSERT_EQ(other.stepper.digest(other.state), rig_->stepper.digest(rig_->state)) << "step " << i;
  }
  std::vector<std::byte> turned = bytes;
  turned.resize(turned.size() - 8);
  EXPECT_FALSE(restoreState(*model_, turned, other.state));
}

TEST(FatInAModel, SaysWhatIsWrong) {
  SceneDescription scene = padScene();
  scene.fat[0].attachments[0].to = "spleen";
  expectNames(Model::build(scene).error, {"fat 'pad': ", "'spleen'"});
  scene = padScene();
  scene.fat[0].surface.triangle.pop_back();
  EXPECT_NE(Model::build(scene).error.find("fat 'pad': "), std::string::npos) << Model::build(scene).error;
}

}  // namespace
}  // namespace calot::fat_scene_test

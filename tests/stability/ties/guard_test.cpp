// SPDX-License-Identifier: GPL-3.0-or-later
// A step that leaves something absurdly fast says so; one that does not, does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// A ball in free space: what speed it has it keeps.
SceneDescription ballScene() {
  SceneDescription scene = test::blockScene(400, 4);
  scene.name = "free ball";
  scene.organs[0].name = "ball";
  scene.organs[0].surface = test::sphereSurface(Vec3::Zero(), 0.015, 4);
  scene.organs[0].anchors.clear();
  scene.organs[0].material.massDamping = 0.0;
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  return scene;
}

std::size_t toldOf(const Model& model, double speed, double& value) {
  test::Rig rig(model);
  rig.state.organ[0].quietSteps = 0;
  for (Vec3& v : rig.state.organ[0].velocity) v = Vec3(0.0, -speed, 0.0);
  const StepResult& result = rig.step(model.scene().hands[0].home);
  const auto told = std::count_if(result.events.begin(), result.events.end(),
                                  [](const Event& e) { return e.kind == EventKind::runaway; });
  EXPECT_EQ((result.misses & miss::runaway) != 0, told > 0);
  for (const Event& e : result.events) {
    if (e.kind == EventKind::runaway) value = e.value;
  }
  return static_cast<std::size_t>(told);
}

TEST(Guard, TellsOfWhatIsTooFast) {
  const std::unique_ptr<const Model> model = test::buildModel(ballScene());
  ASSERT_TRUE(model);
  double value = 0.0;
  EXPECT_EQ(toldOf(*model, 0.95 * maxTissueSpeed, value), 0U);
  EXPECT_EQ(toldOf(*model, 1.05 * maxTissueSpeed, value), 1U);
  EXPECT_NEAR(value, 1.05 * maxTissueSpeed, 0.01 * maxTissueSpeed);
}

/// One node that is far faster than the rest of its organ is held back, and that is told; the organ as a whole may
/// move.
TEST(Guard, HoldsBackWhatLeavesTheRestBehind) {
  const std::unique_ptr<const Model> model = test::buildModel(ballScene());
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  rig.state.organ[0].quietSteps = 0;
  rig.state.organ[0].velocity[0] = Vec3(4000.0, 0.0, 0.0);
  const StepResult& result = rig.step(model->scene().hands[0].home);
  EXPECT_NE(result.misses & miss::speed, 0U);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& v : rig.state.organ[0].velocity) mean += v;
  mean /= static_cast<double>(rig.state.organ[0].velocity.size());
  double largest = 0.0;
  for (const Vec3& v : rig.state.organ[0].velocity) largest = std::max(largest, (v - mean).norm());
  EXPECT_LT(largest, 10.0);
  const auto told = std::find_if(result.events.begin(), result.events.end(),
                                 [](const Event& e) { return e.kind == EventKind::motionHeldBack; });
  ASSERT_NE(told, result.events.end());
  EXPECT_GT(told->value, 5.0);
}

}  // namespace
}  // namespace calot

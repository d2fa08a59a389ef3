// SPDX-License-Identifier: GPL-3.0-or-later
// All fat carved away.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr std::size_t fatStructure = 1;  // after the block
const Vec3 lower(-0.005, -0.004, test::blockTop + 0.0002);
const Vec3 upper(0.005, 0.004, test::blockTop + 0.0042);

SceneDescription smallPad() {
  SceneDescription scene = test::blockScene(150, 5);
  scene.name = "small pad of fat";
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(lower, upper, {4, 4, 2});
  fat.cellSize = 0.0006;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}};
  scene.fat.push_back(fat);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.05);
  scene.hands[0].instrument = InstrumentKind::hook;
  return scene;
}

/// The hook goes to and fro through the whole pad, row by row and layer by layer, until nothing is left. The steps go
/// on: nothing of the fat is a number no more, nothing of it is touched, and what it hung on is at rest.
TEST(NothingLeft, StepsGoOnWithoutFat) {
  const SceneDescription scene = smallPad();
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  int steps = 0;
  double volume = 1.0;
  const auto stepAt = [&](const Vec3& tip, bool current) -> const StepResult& {
    TickSamples tick;
    tick.camera = scene.camera;
    tick.hand[0].position = tip;
    tick.hand[0].instrument = InstrumentKind::hook;
    tick.hand[0].buttons = current ? button::cutPedal : 0;
    tick.hand[1].position = scene.hands[1].home;
    const std::vector<TickSamples> ticks(scene.ticksPerStep, tick);
    const StepResult& result = rig.stepper.step(rig.state, ticks);
    EXPECT_TRUE(test::allFinite(rig.state)) << "step " << steps;
    EXPECT_TRUE(test::allFinite(result)) << "step " << steps;
    EXPECT_EQ(result.misses & miss::runaway, 0U) << "step " << steps;
    volume = result.fat[0].volume;
    ++steps;
    return result;
  };
  const double begin = stepAt(scene.hands[0].home, false).fat[0].volume;
  ASSERT_GT(begin, 0.8 * 0.010 * 0.008 * 0.004);
  // Down to the block's top and somewhat into it, which gives way.
  for (double z = upper[2] - 0.0005; z > test::blockTop - 0.002 && volume > 0.0; z -= 0.0008) {
    int row = 0;
    for (double y = lower[1] - 0.001; y < upper[1] + 0.0015 && volume > 0.0; y += 0.001, ++row) {
      const double side = row % 2 == 0 ? 1.0 : -1.0;
      for (double x = -0.008; x < 0.008 && volume > 0.0 && !HasFailure(); x += 0.0004) {
        stepAt(Vec3(side * x, y, z), true);
      }
    }
    ASSERT_FALSE(HasFailure());
  }
  std::printf("%.0f mm^3 of fat gone after %d steps\n", 1e9 * (begin - volume), steps);
  ASSERT_EQ(volume, 0.0);
  // Where it was, the hook meets the block alone, with and without current.
  bool touchedBlock = false;
  for (int i = 0; i < 300; ++i) {
    const Vec3 tip(0.004 * (i % 100 - 50) / 50.0, 0.001, test::blockTop + (i < 150 ? 0.002 : -0.001));
    const StepResult& result = stepAt(tip, i % 2 == 0);
    EXPECT_EQ(result.fat[0].volume, 0.0);
    EXPECT_EQ(result.fat[0].carved, 0.0);
    EXPECT_EQ(result.fat[0].residual, 0.0);
    EXPECT_EQ(result.hand[0].touching & (1U << fatStructure), 0U) << "touches what is not there";
    EXPECT_EQ(result.hand[0].structureForce[fatStructure], 0.0);
    touchedBlock = touchedBlock || (result.hand[0].touching & 1U) != 0;
  }
  EXPECT_TRUE(touchedBlock);
  for (int i = 0; i < 400; ++i) stepAt(scene.hands[0].home, false);
  const StepResult& last = stepAt(scene.hands[0].home, false);
  EXPECT_LT(last.organ[0].maxDisplacement, 1e-4);
  EXPECT_LT(last.fat[0].maxSpeed, 1e-3);
  // What is saved of it is restored and goes on alike.
  test::Rig other(*model);
  ASSERT_TRUE(restoreState(*model, saveState(rig.state), other.state));
  EXPECT_EQ(digestOf(other.state), digestOf(rig.state));
}

}  // namespace
}  // namespace calot

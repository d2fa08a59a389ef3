// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/bullet/bullet_tree.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "sim/math/random.h"
#include "tests/sim/contact/support/broad_phase_checks.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

TEST(BulletTree, FindsEveryOverlapSortedAndOnce) {
  SCOPED_TRACE("seed 61");
  BulletTree tree;
  test::checkUpdates(tree, 61);
}

TEST(BulletTree, RefitsWhatMoved) {
  SCOPED_TRACE("seed 62");
  BulletTree tree;
  test::checkRefits(tree, 62);
}

TEST(BulletTree, BoxesThatOnlyTouchOverlap) {
  SCOPED_TRACE("seed 63");
  BulletTree tree;
  test::checkTightBoxes(tree, 63);
}

/// Both decide by the boxes in double at the end, so they agree pair for pair.
TEST(BulletTree, GivesTheGridsPairs) {
  SCOPED_TRACE("seed 64");
  Random random(64);
  BulletTree tree;
  SortedGrid grid(0.02);
  std::size_t pairs = 0;
  std::vector<Box> leaves(250);
  for (Box& box : leaves) box = test::randomBox(random);
  tree.update(leaves);
  grid.update(leaves);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<std::uint32_t> changed;
    for (std::uint32_t l = 0; l < leaves.size(); ++l) {
      if (random.uniform() < 0.8) continue;
      leaves[l] = test::randomBox(random);
      changed.push_back(l);
    }
    tree.refit(leaves, changed);
    grid.refit(leaves, changed);
    std::vector<Box> queries(30);
    for (Box& box : queries) box = test::randomBox(random);
    std::vector<BroadPhase::Pair> a;
    std::vector<BroadPhase::Pair> b;
    tree.pairs(queries, a);
    grid.pairs(queries, b);
    ASSERT_EQ(a, b) << trial;
    pairs += a.size();
  }
  EXPECT_GT(pairs, 1000U);
}

/// Hands that shake at 20 Hz and 2 m/s about a place near the block's top, with turning and changing jaws.
std::vector<TickSamples> violentTicks(const SceneDescription& scene, int step, const std::array<Vec3, handCount>& way) {
  std::vector<TickSamples> ticks = test::ticksAt(scene, Vec3::Zero(), Vec3::Zero());
  constexpr double turn = 2.0 * std::numbers::pi * 20.0;
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const double t = 0.01 * step + 0.001 * static_cast<double>(k);
    for (std::size_t h = 0; h < handCount; ++h) {
      InstrumentSample& sample = ticks[k].hand[h];
      const double side = h == 0 ? -1.0 : 1.0;
      sample.position = Vec3(side * 0.012, 0.004 * std::sin(0.9 * t), test::blockTop + 0.003) +
                        (2.0 / turn) * std::sin(turn * t + side) * way[h];
      sample.orientation = Quat(std::cos(t), 0.0, 0.0, std::sin(t));
      sample.jaw = 0.4 + 0.3 * std::sin(7.0 * t);
      sample.instrument = h == 0 ? InstrumentKind::grasper : InstrumentKind::hook;
    }
  }
  return ticks;
}

TEST(BulletTree, StepsToTheSameStatesAsTheGrid) {
  SceneDescription scene = test::blockAndBallScene();
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  int touched = 0;
  for (const std::uint64_t seed : {65U, 66U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::array<Vec3, handCount> way;
    for (Vec3& w : way) w = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    test::Rig grid(*model);
    test::Rig tree(*model, nullptr, &BulletTree::make);
    for (int step = 0; step < 150; ++step) {
      const std::vector<TickSamples> ticks = violentTicks(model->scene(), step, way);
      const StepResult& result = grid.stepper.step(grid.state, ticks);
      for (const HandResult& hand : result.hand) touched += hand.touching != 0 ? 1 : 0;
      tree.stepper.step(tree.state, ticks);
      ASSERT_EQ(grid.stepper.digest(grid.state).component, tree.stepper.digest(tree.state).component) << step;
    }
    EXPECT_EQ(saveState(grid.state), saveState(tree.state));
  }
  EXPECT_GT(touched, 100) << "the run must press";
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Two organs tied by connective tissue, in whole steps: pulled apart by a grasper, burned by the hook.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "tests/sim/scene/support/scenes.h"
#include "tests/support/message.h"

namespace calot {
namespace {

/// A flat pad over the block, tied to its top over its whole lower face.
SceneDescription connectedPads() {
  SceneDescription scene = test::padOnBlockScene();
  scene.organs.back().material.massDamping = 2.0;
  scene.hands[0].home = Vec3(-0.012, 0.0, 0.05);
  scene.hands[1].home = Vec3(0.04, 0.0, 0.05);
  scene.hands[1].instrument = InstrumentKind::hook;
  scene.hands[0].tearForce = 50.0;
  scene.hands[0].slipForce = 20.0;
  return scene;
}

/// The left hand comes down with open jaws, closes them on the pad's top and pulls it up; the right one goes where it
/// is told, with its pedal pressed or not.
struct Surgery {
  double lift = 0.0;    ///< m
  double speed = 0.02;  ///< m/s
  Vec3 hook = Vec3(0.04, 0.0, 0.05);
  bool pedal = false;

  [[nodiscard]] TickSamples at(const SceneDescription& scene, double t) const {
    TickSamples tick;
    tick.camera = scene.camera;
    const double top = test::blockTop + 0.0145;
    InstrumentSample& left = tick.hand[0];
    const double down = std::min(1.0, t / 0.4);
    left.position = Vec3(-0.002, 0.0, 0.05 + (top - 0.05) * down + std::clamp(speed * (t - 0.9), 0.0, lift));
    left.jaw = t < 0.5 ? 0.8 : std::max(0.0, 0.8 - 4.0 * (t - 0.5));
    left.buttons = button::lock;
    InstrumentSample& right = tick.hand[1];
    right.instrument = InstrumentKind::hook;
    right.position = hook;
    Mat3 frame;  // the hook's end points to -x
    frame << 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
    right.orientation = Quat(frame);
    right.buttons = pedal ? button::coagulatePedal : std::uint8_t{0};
    return tick;
  }
};

const StepResult& step(test::Rig& rig, const SceneDescription& scene, const Surgery& surgery) {
  std::vector<TickSamples> ticks;
  for (std::uint32_t k = 0; k < scene.ticksPerStep; ++k) {
    ticks.push_back(surgery.at(scene, 0.001 * static_cast<double>(rig.state.clock.step * scene.ticksPerStep + k)));
  }
  return rig.stepper.step(rig.state, ticks);
}

class ConnectiveScene : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(connectedPads()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }
  [[nodiscard]] static const SceneDescription& scene() { return model_->scene(); }
  static inline std::unique_ptr<const Model> model_;
};

TEST_F(ConnectiveScene, RestIsRestAndSleeps) {
  test::Rig rig(*model_);
  for (int i = 0; i < 100; ++i) {
    const StepResult& result = step(rig, scene(), {});
    if (i > 20) continue;
    EXPECT_TRUE(result.organ[0].asleep);
    EXPECT_TRUE(result.organ[1].asleep);
    EXPECT_EQ(result.connective[0].attached, 1.0);
  }
  ASSERT_GE(model_->connective()[0].tissue.strands().size(), 200U);
  EXPECT_NEAR(model_->connective()[0].tissue.area(), 9e-4, 1e-5);
}

/// The pull of the hand goes through the strands into the block; both organs are awake; the digest that hashes only
/// what was written is that of everything.
TEST_F(ConnectiveScene, ThePullGoesThroughTheStrands) {
  test::Rig rig(*model_);
  Surgery surgery;
  surgery.lift = 0.003;
  for (int i = 0; i < 600; ++i) {
    const StepResult& result = step(rig, scene(), surgery);
    EXPECT_EQ(rig.stepper.digest(rig.state), digestOf(rig.state));
    EXPECT_EQ(result.misses, 0U);
    if (i < 120) continue;
    EXPECT_FALSE(result.organ[0].asleep);
    EXPECT_FALSE(result.organ[1].asleep);
    ASSERT_EQ(result.hand[0].grasping, 2U);
  }
  const StepResult& last = step(rig, scene(), surgery);
  double tension = 0.0;
  const ConnectiveTissue& tissue = model_->connective()[0].tissue;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    tension +=
        strandTension(tissue, rig.state.connective[0], s, rig.state.organ[1].position, rig.state.organ[0].position);
  }
  EXPECT_GT(last.hand[0].graspForce, 0.1);
  EXPECT_NEAR(tension, last.hand[0].graspForce, 0.05 * last.hand[0].graspForce);
  EXPECT_EQ(last.connective[0].attached, 1.0);
}

/// Pulled on, strands tear from where they are pulled most until the pad is free; each is told once; residue is all.
TEST_F(ConnectiveScene, PulledHardItTearsOff) {
  test::Rig rig(*model_);
  Surgery surgery;
  surgery.lift = 0.06;
  surgery.speed = 0.05;
  double torn = 0.0;
  int freed = 0;
  for (int i = 0; i < 320; ++i) {
    const StepResult& result = step(rig, scene(), surgery);
    ASSERT_TRUE(rig.state.organ[1].position[0].allFinite());
    for (const Event& event : result.events) {
      if (event.kind == EventKind::strandsTorn) torn += event.value;
      if (event.kind == EventKind::connectiveFreed) ++freed;
    }
    EXPECT_NEAR(result.connective[0].torn, torn, 1e-9);
    EXPECT_NEAR(result.connective[0].attached + result.connective[0].torn, 1.0, 1e-9);
  }
  EXPECT_NEAR(torn, 1.0, 1e-9);
  EXPECT_EQ(freed, 1);
  // The block is left alone and goes back to its shape.
  EXPECT_LT(step(rig, scene(), surgery).organ[0].maxDisplacement, 2e-4);
}

/// The hook burns with its pedal pressed only; burned strands do not come back.
TEST_F(ConnectiveScene, TheHookBurnsWithItsPedal) {
  for (const bool pedal : {false, true}) {
    test::Rig rig(*model_);
    Surgery surgery;
    surgery.pedal = pedal;
    // Down beside the pad, then in from the side, the hook's end ahead in the gap.
    double burned = 0.0;
    for (int i = 0; i < 250; ++i) {
      const double low = test::blockTop + 0.0005;
      const double in = std::clamp(2e-4 * (i - 60), 0.0, 0.0115);
      surgery.hook = Vec3(0.03 - in, 0.0, i < 60 ? 0.05 + (low - 0.05) * i / 60.0 : low);
      const StepResult& result = step(rig, scene(), surgery);
      for (const Event& event : result.events) {
        if (event.kind == EventKind::strandsBurned) burned += event.value;
      }
      EXPECT_NEAR(result.connective[0].burned, burned, 1e-9);
    }
    if (pedal) {
      EXPECT_GT(burned, 0.004);
      const ConnectiveTissue& tissue = model_->connective()[0].tissue;
      for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
        const Vec3 place = tissue.strands()[s].b.of(model_->organs()[0].solid.rest());
        const bool near = (place - Vec3(0.0139, 0.0, test::blockTop)).norm() < 0.003;
        if (!near) {
          EXPECT_EQ(rig.state.connective[0].condition[s], StrandCondition::attached) << s;
        }
      }
    } else {
      EXPECT_EQ(burned, 0.0);
      EXPECT_EQ(rig.state.connective[0].alpha, std::vector<double>(rig.state.connective[0].alpha.size(), 1.0));
    }
  }
}

/// A state that was saved in the middle goes on with the same bits.
TEST_F(ConnectiveScene, ARestoredStateGoesOnWithTheSameBits) {
  test::Rig first(*model_);
  Surgery surgery;
  surgery.lift = 0.06;
  surgery.speed = 0.05;
  for (int i = 0; i < 170; ++i) step(first, scene(), surgery);
  const std::vector<std::byte> saved = saveState(first.state);
  test::Rig second(*model_);
  ASSERT_TRUE(restoreState(*model_, saved, second.state));
  second.stepper.invalidate();
  for (int i = 0; i < 60; ++i) {
    step(first, scene(), surgery);
    step(second, scene(), surgery);
    ASSERT_EQ(digestOf(first.state), digestOf(second.state)) << i;
  }
  const std::vector<double>& damage = first.state.connective[0].damage;
  EXPECT_GT(*std::max_element(damage.begin(), damage.end()), 0.0) << "the run must soften strands";
  State untouched = first.state;
  EXPECT_FALSE(restoreState(*model_, std::span(saved).first(saved.size() - 1), untouched));
}

TEST(ConnectiveDescription, WhatIsWrongIsSaid) {
  const auto errorOf = [](auto&& change) {
    SceneDescription scene = connectedPads();
    change(scene.connective[0]);
    return Model::build(scene).error;
  };
  expectNames(errorOf([](ConnectiveDescription& c) { c.second = "spleen"; }), {"'bed': ", "'spleen'"});
  expectNames(errorOf([](ConnectiveDescription& c) { c.second = "pad"; }), {"'bed': ", "'pad'"});
  expectNames(errorOf([](ConnectiveDescription& c) { c.fractureEnergy = 39.0; }), {"40.000000 J/m^2"});
  EXPECT_EQ(errorOf([](ConnectiveDescription& c) { c.fractureEnergy = 40.0; }), "");
  expectNames(errorOf([](ConnectiveDescription& c) { c.reach = 1e-4; }), {"bed"});
}

}  // namespace
}  // namespace calot

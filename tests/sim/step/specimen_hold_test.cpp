// SPDX-License-Identifier: GPL-3.0-or-later
// Fat that holds the specimen, in whole steps: a duct grown to it, with fat between both, cut on either side of the
// fat.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "sim/judgement/judge.h"
#include "sim/scene/step_result.h"
#include "tests/sim/scene/support/scenes.h"
#include "tests/support/message.h"

namespace calot {
namespace {

constexpr double padHeight = test::blockTop + 0.006;
constexpr double padFrom = -0.005, padTo = 0.007;  // of the fat along the duct (m)

/// A duct comes from a place that is fixed and is grown to the block; fat ties it to the block on the way.
SceneDescription tiedDuct() {
  SceneDescription scene = test::blockScene(300, 6);
  scene.name = "tied duct";
  VesselDescription duct;
  duct.name = "duct";
  duct.path = {Vec3(-0.045, 0.0, padHeight), Vec3(0.02, 0.0, padHeight), Vec3(0.024, 0.0, test::blockTop)};
  duct.radius = 0.0015;
  duct.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  duct.start.kind = VesselEndDescription::Kind::fixed;
  duct.end.kind = VesselEndDescription::Kind::organ;
  duct.end.to = "block";
  scene.vessels.push_back(duct);
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(padFrom, -0.005, test::blockTop + 0.0002), Vec3(padTo, 0.005, padHeight + 0.003),
                                 {6, 5, 4});
  fat.cellSize = 0.001;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}, {"duct", 0.001, 2e7, 2e5}};
  scene.fat.push_back(fat);
  scene.procedure.specimen = "block";
  scene.procedure.fat = "pad";
  scene.procedure.divide = {{"duct", 0, 0, true}};
  scene.hands[0].home = Vec3(0.0, 0.0, 0.06);
  scene.hands[1].home = Vec3(0.05, 0.0, 0.06);
  return scene;
}

class Holding : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(tiedDuct()); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(model_);
    rig_ = std::make_unique<test::Rig>(*model_);
    judge_ = std::make_unique<Judge>(model_->scene());
  }
  void step(const Vec3& tip, double jaw) {
    TickSamples tick;
    tick.camera = model_->scene().camera;
    InstrumentSample& hand = tick.hand[0];
    hand.position = tip;
    Mat3 frame;  // jaws open across the duct
    frame << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    hand.orientation = Quat(frame);
    hand.jaw = jaw;
    hand.instrument = InstrumentKind::scissors;
    tick.hand[1].position = model_->scene().hands[1].home;
    result_ = rig_->stepper.step(rig_->state, std::vector<TickSamples>(model_->scene().ticksPerStep, tick));
    judge_->observe(result_);
    EXPECT_EQ(rig_->stepper.digest(rig_->state), digestOf(rig_->state));
  }
  void cutAt(double x) {
    constexpr double below = 0.006;
    for (int i = 0; i <= 40; ++i) step(Vec3(x, 0.0, 0.06 + (padHeight - below - 0.06) * i / 40.0), 0.9);
    for (int i = 0; i <= 20; ++i) step(Vec3(x, 0.0, padHeight - below), 0.9 - 0.04 * i);
    ASSERT_EQ(result_.vessel[0].partings, 1U);
  }

  static inline std::unique_ptr<const Model> model_;
  std::unique_ptr<test::Rig> rig_;
  std::unique_ptr<Judge> judge_;
  StepResult result_;
};

TEST_F(Holding, WhatHangsOnTheSpecimenAloneDoesNotHoldIt) {
  step(Vec3(0.0, 0.0, 0.06), 0.9);
  EXPECT_TRUE(result_.fat[0].holdsSpecimen) << "it joins the block with the duct, which is fixed";
  cutAt(-0.016);
  EXPECT_FALSE(result_.fat[0].holdsSpecimen) << "this piece of the duct hangs on the block";
  EXPECT_EQ(judge_->judgement().phase, Phase::done);
  // Asked anew, as after a restore, the answer is the same.
  rig_->stepper.invalidate();
  step(Vec3(-0.016, 0.0, 0.06), 0.9);
  EXPECT_FALSE(result_.fat[0].holdsSpecimen);
}

TEST_F(Holding, FatThatJoinsItWithTheStumpThatStaysDoes) {
  cutAt(0.014);
  EXPECT_TRUE(result_.fat[0].holdsSpecimen);
  EXPECT_NE(judge_->judgement().phase, Phase::done) << "the duct is divided, the fat is not";
  rig_->stepper.invalidate();
  step(Vec3(0.014, 0.0, 0.06), 0.9);
  EXPECT_TRUE(result_.fat[0].holdsSpecimen);
}

}  // namespace
}  // namespace calot

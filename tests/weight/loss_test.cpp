// SPDX-License-Identifier: GPL-3.0-or-later
// What loses what holds it: a body that is freed falls, what is burned or cut takes its load along, sleepers wake.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "sim/vessel/beam_model.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

const Vec3 down(0.0, 0.0, 9.81);  ///< the block is the ceiling

/// A pad that hangs from a block by strands.
SceneDescription hangingPad() {
  SceneDescription scene = test::padOnBlockScene();
  scene.name = "pad under a ceiling";
  scene.gravity = down;
  scene.organs.back().material.massDamping = 0.0;
  scene.hands[0].home = Vec3(-0.1, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  return scene;
}

struct Centre {
  Vec3 place = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

Centre centreOf(const Model& model, const State& state, std::size_t organ) {
  const SolidModel& solid = model.organs()[organ].solid;
  Centre out;
  for (std::size_t n = 0; n < solid.nodes(); ++n) {
    out.place += solid.mass()[n] / solid.wholeMass() * state.organ[organ].position[n];
    out.velocity += solid.mass()[n] / solid.wholeMass() * state.organ[organ].velocity[n];
  }
  return out;
}

void burnAll(ConnectiveState& tissue) {
  std::fill(tissue.condition.begin(), tissue.condition.end(), StrandCondition::burned);
  std::fill(tissue.alpha.begin(), tissue.alpha.end(), 0.0);
}

/// At rest the strands bear the pad's weight, and no strand more than its share of the bed allows.
TEST(LossOfHold, StrandsBearWhatHangsOnThem) {
  for (const Vec3& gravity : {down, Vec3(9.81, 0.0, 0.0), Vec3(3.0, -4.0, 8.0)}) {
    SceneDescription scene = hangingPad();
    scene.gravity = gravity;
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    Vec3 borne = Vec3::Zero();
    for (const Strand& strand : model->connective()[0].tissue.strands()) borne += strand.load;
    const Vec3 weight = model->organs()[1].solid.wholeMass() * gravity;
    EXPECT_LT((borne + weight).norm(), 1e-9 * weight.norm());
  }
}

/// A strand's load is the force on the ends that an attached strand has at rest; it fades with what is left of it and
/// goes with it.
TEST(LossOfHold, AStrandTakesItsLoadAlong) {
  const std::unique_ptr<const Model> model = test::buildModel(hangingPad());
  ASSERT_TRUE(model);
  const ConnectiveModel& bed = model->connective()[0];
  const SolidState a = restState(model->organs()[bed.a].solid);
  SolidState b = restState(model->organs()[bed.b].solid);
  const auto forcesOf = [&](const ConnectiveState& state) {
    ConnectiveLoads loads;
    linearise(bed.tissue, state, {a.position, a.velocity, a.rotation}, {b.position, b.velocity, b.rotation}, 0.01,
              loads);
    return loads;
  };
  ConnectiveState state = intactState(bed.tissue);
  const Vec3 load = bed.tissue.strands()[0].load;
  ASSERT_GT(load.norm(), 1e-5);
  const double rounding = 1e-12 * load.norm();
  EXPECT_LT((forcesOf(state).onA[0].force - load).norm(), rounding);
  EXPECT_LT((forcesOf(state).onB[0].force + load).norm(), rounding);
  state.alpha[0] = 0.5;
  EXPECT_LT((forcesOf(state).onA[0].force - 0.5 * load).norm(), rounding);
  state.damage[0] = 0.4;
  EXPECT_LT((forcesOf(state).onA[0].force - 0.3 * load).norm(), rounding);
  for (RotationGroup& group : b.rotation) {  // a quarter about z
    group[0].fill(std::sqrt(0.5));
    group[3].fill(std::sqrt(0.5));
  }
  const Vec3 rotated(-load[1], load[0], load[2]);
  EXPECT_LT((forcesOf(state).onA[0].force - 0.3 * rotated).norm(), rounding);
  const std::size_t all = forcesOf(state).onA.size();
  state.condition[0] = StrandCondition::torn;
  EXPECT_EQ(forcesOf(state).onA.size(), all - 1);
}

/// Loads of elements push a freed body nowhere: its centre falls with g, however it springs.
TEST(LossOfHold, AFreedPadFallsWithG) {
  SceneDescription scene = hangingPad();
  scene.solver.tolerance = 1e-6;
  scene.solver.speedTolerance = 0.0;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  burnAll(rig.state.connective[0]);
  rig.state.organ[0].quietSteps = rig.state.organ[1].quietSteps = 0;
  for (int i = 1; i <= 10; ++i) {
    rig.step(scene.hands[0].home);
    const Vec3 velocity = centreOf(*model, rig.state, 1).velocity;
    EXPECT_LT((velocity - 0.01 * i * down).norm(), 1e-5 * 0.01 * i * 9.81) << i;
  }
  EXPECT_GT(rig.state.organ[0].maxDisplacement, 1e-6) << "the ceiling springs back";
}

/// The hook burns a part of a sleeping bed: the pad wakes, sinks, and sleeps again, lower.
TEST(LossOfHold, ASleeperWakesAndSags) {
  SceneDescription scene = hangingPad();
  scene.organs[1].material.massDamping = 4.0;
  scene.hands[1].instrument = InstrumentKind::hook;
  scene.connective[0].fadeTime = 0.05;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  const double start = centreOf(*model, rig.state, 1).place[2];
  bool sleptFirst = false;
  bool woke = false;
  bool asleep = false;
  for (int i = 0; i < 1200; ++i) {
    // Down beside the pad, in, along its edge with the hook's end in the gap, out and up.
    const double low = test::blockTop + 0.001;
    const double in = std::clamp(2e-4 * (i - 60), 0.0, 0.0125) - std::clamp(1e-3 * (i - 280), 0.0, 0.0125);
    const double along = std::clamp(2e-4 * (i - 130) - 0.014, -0.014, 0.014);
    const double high = i < 60 ? 0.05 + (low - 0.05) * i / 60.0 : std::clamp(low + 1e-3 * (i - 300), low, 0.08);
    TickSamples tick;
    tick.camera = scene.camera;
    tick.hand[0].position = scene.hands[0].home;
    tick.hand[1].instrument = InstrumentKind::hook;
    tick.hand[1].position = Vec3(0.03 - in, along, high);
    Mat3 frame;  // the hook's end points to -x
    frame << 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
    tick.hand[1].orientation = Quat(frame);
    tick.hand[1].buttons = i < 280 ? button::coagulatePedal : std::uint8_t{0};
    const StepResult& result = rig.stepper.step(rig.state, std::vector<TickSamples>(scene.ticksPerStep, tick));
    sleptFirst = sleptFirst || (i < 40 && result.organ[1].asleep);
    woke = woke || !result.organ[1].asleep;
    asleep = result.organ[1].asleep;
  }
  const double sag = centreOf(*model, rig.state, 1).place[2] - start;
  const double burned = sharesOf(model->connective()[0].tissue, rig.state.connective[0]).burned;
  std::printf("%.1f %% of the bed burned: the pad hangs %.3f mm lower\n", 100.0 * burned, 1e3 * sag);
  EXPECT_TRUE(sleptFirst);
  EXPECT_TRUE(woke);
  EXPECT_TRUE(asleep);
  EXPECT_GT(sag, 1e-5);
  EXPECT_GT(burned, 0.03);
}

/// A vessel that is cut wakes, and its stumps droop; the parted element bears nothing more.
TEST(LossOfHold, ACutVesselsStumpsDroop) {
  SceneDescription scene = test::blockScene(150, 4);
  scene.gravity = -down;
  VesselDescription duct;
  duct.name = "duct";
  duct.path = {Vec3(-0.03, 0.0, 0.05), Vec3(0.03, 0.0, 0.05)};
  duct.elements = 40;
  duct.material = {2e5, 0.45, 1050.0, 5.0, 0.01};
  duct.start.kind = duct.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(duct);
  scene.hands[0].home = Vec3(-0.04, 0.0, 0.1);
  scene.hands[1].home = Vec3(0.04, 0.0, 0.1);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  const BeamModel& beams = model->vesselTrees()[0].beams;
  test::Rig rig(*model);
  EXPECT_TRUE(rig.step(scene.hands[0].home).vessel[0].asleep);
  ASSERT_TRUE(part(rig.state.vessel[0], pointAt(beams, 0, 0.5 * beams.branches()[0].length()), Parting::cut));
  bool asleep = true;
  for (int i = 0; i < 600; ++i) asleep = rig.step(scene.hands[0].home).vessel[0].asleep;
  EXPECT_TRUE(asleep);
  // Each stump is a cantilever that was loaded as half of a clamped beam, q L^4 / 384 EI with L its whole length: it
  // sinks by q l^4 / 8 EI of its own less what it had at the middle.
  const TubeSection section = beams.branches()[0].section;
  const double q = duct.material.density * section.area() * 9.81;
  const double stiffness = duct.material.youngModulus * section.secondMoment();
  const double stump = 0.03;
  const double expected =
      q * stump * stump * stump * stump / 8.0 / stiffness - q * 0.06 * 0.06 * 0.06 * 0.06 / 384.0 / stiffness;
  double sunk = 0.0;
  for (std::size_t n = 0; n < beams.nodes(); ++n) {
    sunk = std::max(sunk, beams.rest()[n][2] - rig.state.vessel[0].position[n][2]);
  }
  std::printf("stumps sink by %.3f mm, to first order %.3f mm\n", 1e3 * sunk, 1e3 * expected);
  EXPECT_NEAR(sunk, expected, 0.15 * expected);
}

/// What bears fat is relieved as that is carved, and wakes.
TEST(LossOfHold, WhatBearsFatWakesAsItIsCarved) {
  SceneDescription scene = test::blockScene(300, 6);
  scene.gravity = -down;
  FatDescription fat;
  fat.name = "pad";
  fat.appearance = "fat";
  fat.surface = test::boxSurface(Vec3(-0.012, -0.010, test::blockTop + 0.0002),
                                 Vec3(0.012, 0.010, test::blockTop + 0.010), {8, 8, 4});
  fat.cellSize = 0.001;
  fat.attachments = {{"block", 0.0015, 2e7, 2e5}};
  scene.fat.push_back(fat);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.06);
  scene.hands[1].home = Vec3(0.04, 0.0, 0.06);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  bool carved = false;
  for (int i = 0; i < 120; ++i) {
    TickSamples tick;
    tick.camera = scene.camera;
    tick.hand[0].instrument = InstrumentKind::hook;
    tick.hand[0].position = Vec3(0.0, 0.0, std::max(test::blockTop + 0.007, 0.06 - 1e-3 * i));
    tick.hand[0].buttons = button::cutPedal;
    tick.hand[1].position = scene.hands[1].home;
    const StepResult& result = rig.stepper.step(rig.state, std::vector<TickSamples>(scene.ticksPerStep, tick));
    if (!(result.fat[0].carved > 0.0)) continue;
    carved = true;
    EXPECT_LE(rig.state.organ[0].quietSteps, 1U) << i;
    EXPECT_EQ(rig.stepper.digest(rig.state), digestOf(rig.state)) << i;
  }
  EXPECT_TRUE(carved);
}

}  // namespace
}  // namespace calot

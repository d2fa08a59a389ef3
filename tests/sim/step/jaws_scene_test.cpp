// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws take what lies between them, and nothing that is merely near: over three meshes and three steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double ductHeight = 0.05;  ///< of the duct's centre line (m)
constexpr double ductRadius = 0.002;

SceneDescription ductInTheOpen(std::uint32_t elements, std::uint32_t ticksPerStep) {
  SceneDescription scene = test::blockScene(300, 6);
  VesselDescription d;
  d.name = "duct";
  d.role = StructureRole::cysticDuct;
  d.path = {Vec3(-0.02, 0.0, ductHeight), Vec3(0.02, 0.0, ductHeight)};
  d.radius = ductRadius;
  d.wall = 0.001;
  d.elements = elements;
  d.material = {1e6, 0.45, 1050.0, 5.0, 0.01};
  d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(d);
  scene.ticksPerStep = ticksPerStep;
  scene.hands[0].port = Vec3(0.0, 0.0, 0.3);
  scene.hands[0].home = Vec3(0.0, 0.0, 0.09);
  scene.hands[1].port = Vec3(0.1, 0.0, 0.3);
  scene.hands[1].home = Vec3(0.1, 0.0, 0.1);
  return scene;
}

/// What one closing did.
struct Closing {
  int grasps = 0, clips = 0, dropped = 0, cuts = 0;
  std::uint32_t contacts = 0;
  double gripForce = 0.0;
};

/// Comes down with open jaws, closes them; jaws open across the duct.
Closing closeOn(const SceneDescription& scene, InstrumentKind instrument, const Vec3& tip) {
  const auto model = test::buildModel(scene);
  test::Rig rig(*model);
  Closing out;
  const double h = model->stepSeconds();
  for (double t = 0.0; t < 1.6; t += h) {
    TickSamples tick;
    tick.camera = scene.camera;
    InstrumentSample& hand = tick.hand[0];
    hand.instrument = instrument;
    const double down = std::min(1.0, t / 0.6);
    const Vec3 above(tip[0], tip[1], 0.09);
    hand.position = above + down * (tip - above);
    hand.jaw = t < 0.8 ? 0.9 : std::max(0.0, 0.9 - 3.0 * (t - 0.8));
    Mat3 frame;
    frame << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
    hand.orientation = Quat(frame);
    tick.hand[1].position = scene.hands[1].home;
    const StepResult& result = rig.stepper.step(rig.state, std::vector<TickSamples>(scene.ticksPerStep, tick));
    for (const Event& e : result.events) {
      out.grasps += e.kind == EventKind::graspBegin ? 1 : 0;
      out.clips += e.kind == EventKind::clipSet ? 1 : 0;
      out.dropped += e.kind == EventKind::clipDropped ? 1 : 0;
      out.cuts += e.kind == EventKind::vesselCut ? 1 : 0;
    }
    out.contacts = result.hand[0].contacts();
    out.gripForce = result.hand[0].gripForce;
  }
  return out;
}

class Jaws : public testing::TestWithParam<std::tuple<std::uint32_t, std::uint32_t>> {};

TEST_P(Jaws, TakeWhatLiesBetweenThem) {
  const SceneDescription scene = ductInTheOpen(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const Vec3 between(0.001, 0.0, ductHeight - 0.004);
  EXPECT_EQ(closeOn(scene, InstrumentKind::grasper, between).grasps, 1);
  EXPECT_EQ(closeOn(scene, InstrumentKind::clipApplier, between).clips, 1);
  EXPECT_EQ(closeOn(scene, InstrumentKind::scissors, between).cuts, 1);
}

/// A duct that lies 2.5 mm before the tips, or beside the closing jaws, is near their line and not between them.
TEST_P(Jaws, TakeNothingThatIsMerelyNear) {
  const SceneDescription scene = ductInTheOpen(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const Vec3 before(0.001, 0.0, ductHeight + ductRadius + 0.0025);
  const Vec3 beside(0.001, 0.0115, ductHeight - 0.004);
  for (const Vec3& tip : {before, beside}) {
    EXPECT_EQ(closeOn(scene, InstrumentKind::grasper, tip).grasps, 0);
    const Closing applier = closeOn(scene, InstrumentKind::clipApplier, tip);
    EXPECT_EQ(applier.clips, 0);
    EXPECT_EQ(applier.dropped, 1);
    EXPECT_EQ(closeOn(scene, InstrumentKind::scissors, tip).cuts, 0);
  }
}

/// What jaws hold counts as contact, though they stand in it without pressing, and the grip is told.
TEST_P(Jaws, HoldingIsContact) {
  const SceneDescription scene = ductInTheOpen(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const Closing held = closeOn(scene, InstrumentKind::grasper, Vec3(0.001, 0.0, ductHeight - 0.004));
  EXPECT_NE(held.contacts & 2U, 0U);
  EXPECT_NEAR(held.gripForce, scene.hands[0].slipForce, 1e-12) << "closed jaws, no ratchet";
}

INSTANTIATE_TEST_SUITE_P(MeshesAndSteps, Jaws,
                         testing::Combine(testing::Values(16U, 40U, 120U), testing::Values(5U, 10U, 20U)),
                         [](const auto& which) {
                           return std::to_string(std::get<0>(which.param)) + "elements" +
                                  std::to_string(std::get<1>(which.param)) + "ms";
                         });

}  // namespace
}  // namespace calot

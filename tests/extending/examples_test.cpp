// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the examples of docs/extending that are C++. Pages show excerpts of them (tests/structure/docs_test.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "recorder/sources/devices/device_source.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/tissue/tissues.h"
#include "tests/analytics/checkpoints/support/steps.h"
#include "tests/extending/support/cord_kind.h"
#include "tests/extending/support/examples.h"
#include "tests/recorder/sources/devices/support/device_support.h"

namespace calot {
namespace {

TEST(Extending, ACheckpointFollowsTheSteps) {
  const analytics::CheckpointEntry entry = analytics::longestTouchRows().front();
  analytics::AttemptContext context;
  context.structures = {"liver", "gallbladder"};
  const std::unique_ptr<analytics::Checkpoint> checkpoint = entry.make(context);
  const std::uint32_t touched[] = {0, 1, 1, 0, 1, 1, 1, 0};  // of the liver, by the right hand
  analytics::support::feedTo([&](const recorder::StepRecord& record) { checkpoint->onStep(record, {}); },
                             std::size(touched), [](std::uint64_t, TickSamples&, recorder::TickOutcome&) {},
                             [&](std::uint64_t step, StepResult& result) { result.hand[1].touching = touched[step]; });
  const std::vector<analytics::CheckpointValue> values = checkpoint->values({});
  ASSERT_EQ(values.size(), 2U);
  EXPECT_NEAR(*values[0].value, 0.03, 1e-12);
  EXPECT_EQ(*values[1].value, 0.0);
  EXPECT_EQ(values[0].subject, "liver");
}

TEST(Extending, ADeviceDrivesAHand) {
  const SceneDescription scene = recorder::devicetest::emptyScene();
  recorder::OpenedDevice opened = recorder::pendulumKind.open({"pendulum", "", {}});
  recorder::DeviceSourceSettings settings;
  settings.tickClock = opened.tickClock;
  recorder::DeviceSource source(std::move(opened.device), scene, settings);
  source.waitForFirst(1.0);
  double lowest = 1.0;
  double highest = -1.0;
  TickSamples tick;
  for (std::uint64_t t = 0; t < 2100; ++t) {
    ASSERT_TRUE(source.next(t, tick));
    const double moved = (tick.hand[1].position - scene.hands[1].home).norm();
    lowest = std::min(lowest, moved);
    highest = std::max(highest, moved);
  }
  EXPECT_LT(lowest, 1e-4);
  EXPECT_NEAR(highest, 0.01, 1e-4);
  EXPECT_EQ(source.deviceInfo().name, std::string("pendulum"));
}

TEST(Extending, AnInstrumentHasAShape) {
  InstrumentShape shape;
  ShapeBuilder builder(shape, 0.0, nominalRadius, 0.15);
  instrument::palpator.shape(builder);
  builder.measure();
  const auto capsules = shape.capsules();
  ASSERT_GT(capsules.size(), 1U);
  double tip = -1.0;
  for (const Capsule& c : capsules) tip = std::max(tip, std::max(c.p0.z(), c.p1.z()) + c.radius);
  EXPECT_NEAR(tip, 0.0, 1e-12);  // nothing is in front of the tip
  EXPECT_NEAR(shape.lateralReach(), 0.004, 1e-12);
}

/// The list with one kind more, as sim/tissue/tissues.h would have it.
using WithCords = TissueList<OrganTissue, ConnectiveKind, VesselTissue, FatTissue, example::CordKind>;

TEST(Extending, AKindOfTissueJoinsTheList) {
  static_assert(WithCords::count == Tissues::count + 1);
  static_assert(WithCords::idOf<example::CordKind>() == 4);
  WithCords::Descriptions scene;
  scene.cords = {{"ligament", 2.0}};
  WithCords::Models model;
  ASSERT_EQ(example::CordKind::build(scene, model), "");
  WithCords::States states;
  EXPECT_FALSE(example::CordKind::fits(model, states));
  example::CordKind::start(model, states);
  EXPECT_TRUE(example::CordKind::fits(model, states));
  std::string seen;
  example::CordKind::components(
      states, [&](const char* prefix, std::size_t i, example::CordState&) { seen += prefix + scene.cords[i].name; });
  EXPECT_EQ(seen, "cord.ligament");
  scene.cords[0].strength = 0.0;
  EXPECT_NE(example::CordKind::build(scene, model), "");
}

}  // namespace
}  // namespace calot

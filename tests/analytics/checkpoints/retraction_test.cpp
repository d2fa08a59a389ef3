// SPDX-License-Identifier: GPL-3.0-or-later
// Requests to the assistant, and those that were taken back.
#include <gtest/gtest.h>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using namespace support;

SceneDescription sceneThatRetracts(double stage) {
  SceneDescription scene = operationScene();
  RetractionDescription pull;
  pull.organ = scene.organs.front().name;
  pull.displacement = Vec3(0.0, 0.006, 0.0);
  pull.stage = stage;
  scene.retraction = {pull};
  return scene;
}

TEST(RetractionCheckpoints, CountRequestsAndThoseTakenBack) {
  Operation o(sceneThatRetracts(0.5));
  const auto asked = [&](EventKind kind) {
    o.now.events = {{0, kind, 1, 0, Vec3::Zero(), 0.009}};
    o.step();
    o.now.events.clear();
    o.step();
  };
  for (const EventKind kind : {EventKind::retractionMore, EventKind::retractionMore, EventKind::retractionLess,
                               EventKind::retractionMore, EventKind::graspSlip, EventKind::retractionMore})
    asked(kind);
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("retraction-requests").value, 5.0);
  EXPECT_DOUBLE_EQ(*o.value("retraction-reversals").value, 2.0) << "more, less, more";
}

TEST(RetractionCheckpoints, OfWhoAsksForNothingAreZero) {
  Operation o(sceneThatRetracts(0.5));
  o.step();
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("retraction-requests").value, 0.0);
  EXPECT_DOUBLE_EQ(*o.value("retraction-reversals").value, 0.0);
}

TEST(RetractionCheckpoints, NeedARetractionThatCanBeAskedFor) {
  Operation o(sceneThatRetracts(0.0));
  o.step();
  o.end();
  for (const char* name : {"retraction-requests", "retraction-reversals"}) {
    EXPECT_EQ(o.value(name).availability, Availability::notApplicable);
    expectNames(o.value(name).reason, {"retraction"});
  }
}

}  // namespace
}  // namespace calot::analytics

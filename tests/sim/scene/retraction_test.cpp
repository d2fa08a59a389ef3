// SPDX-License-Identifier: GPL-3.0-or-later
// Where an assistant's pull is, and what requests make of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "sim/scene/state.h"

namespace calot {
namespace {

SceneDescription oneRetraction() {
  SceneDescription scene;
  RetractionDescription pull;
  pull.displacement = Vec3(0.0, 0.006, 0.0);
  pull.start = 0.5;
  pull.duration = 2.0;
  pull.stage = 0.5;
  pull.most = 2.0;
  scene.retraction.push_back(pull);
  return scene;
}

TEST(Retraction, OfTheSceneIsASmoothStepBitForBit) {
  const RetractionState state = retractionsAtStart(oneRetraction());
  for (int step = 50; step < 400; ++step) {
    const double time = 0.01 * step;
    const double s = std::min((time - 0.5) / 2.0, 1.0);
    const RetractionPlace place = retractionAt(state, 0, time);
    EXPECT_EQ(place.share, s * s * (3.0 - 2.0 * s)) << "as versions before requests had it";
    EXPECT_EQ(place.rate, 6.0 * s * (1.0 - s) / 2.0);
  }
}

TEST(Retraction, ARequestSetsOutFromWhereThePullIs) {
  const SceneDescription scene = oneRetraction();
  RetractionState state = retractionsAtStart(scene);
  const RetractionPlace before = retractionAt(state, 0, 1.5);
  askForRetraction(scene.retraction[0], 0, 1.5, true, state);
  const RetractionPlace after = retractionAt(state, 0, 1.5);
  EXPECT_EQ(after.share, before.share);
  EXPECT_EQ(after.rate, before.rate) << "it doesn't stop to go on";
  EXPECT_EQ(state.goal[0], 1.5);
  EXPECT_TRUE(isMoving(state, 0, 1.6));
  const double end = 1.5 + state.takes[0];
  EXPECT_DOUBLE_EQ(state.takes[0], 2.0 * (1.5 - before.share)) << "at the mean speed of the scene's pull";
  EXPECT_FALSE(isMoving(state, 0, end));
  EXPECT_DOUBLE_EQ(retractionAt(state, 0, end).share, 1.5);
  EXPECT_NEAR(retractionAt(state, 0, end).rate, 0.0, 1e-12);
}

TEST(Retraction, StaysWithinItsLimits) {
  const SceneDescription scene = oneRetraction();
  RetractionState state = retractionsAtStart(scene);
  for (int i = 0; i < 2; ++i) askForRetraction(scene.retraction[0], 0, 10.0, true, state);
  EXPECT_EQ(state.goal[0], 2.0);
  const RetractionState most = state;
  askForRetraction(scene.retraction[0], 0, 11.0, true, state);
  EXPECT_EQ(state.goal[0], 2.0);
  EXPECT_EQ(state.begun[0], most.begun[0]) << "asked in vain, it goes on as it was";
  for (int i = 0; i < 9; ++i) askForRetraction(scene.retraction[0], 0, 30.0, false, state);
  EXPECT_EQ(state.goal[0], 0.0);
  EXPECT_EQ(retractionAt(state, 0, 1e3).share, 0.0);
}

TEST(Retraction, AskedBeforeItsStartGoesFartherAtOnce) {
  const SceneDescription scene = oneRetraction();
  RetractionState state = retractionsAtStart(scene);
  askForRetraction(scene.retraction[0], 0, 0.1, true, state);
  EXPECT_EQ(state.begun[0], 0.5);
  EXPECT_DOUBLE_EQ(state.takes[0], 3.0);
  EXPECT_EQ(retractionAt(state, 0, 0.4).share, 0.0);
}

/// Its rate is the derivative of its share, place and rate never jump, and a hand that turns round overshoots little.
TEST(Retraction, ManyRequestsAtAnyTimeLeaveItSmooth) {
  const std::uint64_t seed = 7;
  RecordProperty("seed", std::to_string(seed));
  const SceneDescription scene = oneRetraction();
  const double largestRate = 1.5 / scene.retraction[0].duration;
  Random random(seed, 1);
  for (int run = 0; run < 200; ++run) {
    RetractionState state = retractionsAtStart(scene);
    RetractionPlace last = retractionAt(state, 0, 0.5);
    const double step = 0.001;
    for (int i = 1; i < 8000; ++i) {
      const double time = 0.5 + step * i;
      if (random.uniform() < 0.002) askForRetraction(scene.retraction[0], 0, time, random.uniform() < 0.5, state);
      const RetractionPlace now = retractionAt(state, 0, time);
      ASSERT_NEAR(now.share - last.share, 0.5 * step * (now.rate + last.rate), 1e-3 * step) << run << ' ' << i;
      ASSERT_LE(std::abs(now.rate), 2.0 * largestRate);
      ASSERT_GT(now.share, -0.2);
      ASSERT_LT(now.share, 2.2);
      last = now;
    }
  }
}

}  // namespace
}  // namespace calot

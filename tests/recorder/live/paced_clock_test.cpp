// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/haptic_thread.h"

#include <gtest/gtest.h>

#include "recorder/engine/observer.h"

namespace calot::recorder {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Nanoseconds start = std::chrono::seconds(7);

TEST(PacedClock, TicksAreAMillisecondApart) {
  const PacedClock clock(start);
  EXPECT_EQ(clock.due(0), start);
  EXPECT_EQ(clock.due(1234), start + milliseconds(1234));
}

TEST(PacedClock, ALateTickIsCountedAndCaughtUpWith) {
  PacedClock clock(start);
  EXPECT_TRUE(clock.mayBegin(0, start + microseconds(50), 0));
  EXPECT_FLOAT_EQ(clock.finish(0, start + microseconds(80)), 80e-6F);
  EXPECT_EQ(clock.missed(), 0U);
  // Began in time, but was not ready before the next one was due.
  EXPECT_TRUE(clock.mayBegin(1, clock.due(1), 0));
  EXPECT_FLOAT_EQ(clock.finish(1, clock.due(1) + microseconds(1500)), 1.5e-3F);
  EXPECT_EQ(clock.missed(), 1U);
  EXPECT_TRUE(clock.mayBegin(2, clock.due(2) + milliseconds(99), 0));
  EXPECT_FLOAT_EQ(clock.finish(2, clock.due(2) + milliseconds(99)), 0.099F);
  EXPECT_EQ(clock.due(3), start + milliseconds(3)) << "less than the longest lag moves nothing";
  EXPECT_EQ(clock.stretched(), Nanoseconds(0));
  EXPECT_EQ(clock.maxLateness(), milliseconds(99));
}

TEST(PacedClock, WhatExceedsTheLongestLagStretchesIt) {
  PacedClock clock(start);
  EXPECT_TRUE(clock.mayBegin(5, start + milliseconds(5 + 130), 0)) << "waiting would not help";
  EXPECT_EQ(clock.due(5), start + milliseconds(5 + 30)) << "it is 100 ms late now";
  EXPECT_FLOAT_EQ(clock.finish(5, start + milliseconds(5 + 131)), 0.13F);
  EXPECT_EQ(clock.stretched(), milliseconds(30));
  EXPECT_EQ(clock.due(6), start + milliseconds(36));
}

TEST(PacedClock, TheSimulationsBacklogIsLagToo) {
  PacedClock clock(start);
  EXPECT_TRUE(clock.mayBegin(110, clock.due(110), 100));
  clock.finish(110, clock.due(110));
  EXPECT_FALSE(clock.mayBegin(111, clock.due(111), 101));
  EXPECT_FALSE(clock.mayBegin(111, clock.due(111), 101)) << "the simulation is where it was a millisecond ago";
  EXPECT_TRUE(clock.mayBegin(111, clock.due(111), 92)) << "a step was done";
  EXPECT_FLOAT_EQ(clock.finish(111, clock.due(111)), 0.102F);
  EXPECT_EQ(clock.stretched(), milliseconds(2));
  EXPECT_EQ(clock.missed(), 1U);
  EXPECT_TRUE(clock.mayBegin(112, clock.due(112), -500)) << "a simulation that waits for ticks has no lag";
}

TEST(PacedClock, ATickThatWasInterruptedDoesNotSayThatTheClockWasStretched) {
  PacedClock clock(start);
  EXPECT_TRUE(clock.mayBegin(0, start, 0));
  EXPECT_EQ(clock.finish(0, start + milliseconds(250)), maxLag);
  EXPECT_EQ(clock.maxLateness(), milliseconds(250));
  // The next one does.
  EXPECT_TRUE(clock.mayBegin(1, start + milliseconds(250), 0));
  EXPECT_GT(clock.finish(1, start + milliseconds(250)), maxLag);
}

TEST(PacedClock, APauseIsNeitherLateNorStretched) {
  PacedClock clock(start);
  clock.pause(milliseconds(4000));
  EXPECT_TRUE(clock.mayBegin(0, start + milliseconds(4000), 0));
  EXPECT_EQ(clock.finish(0, start + milliseconds(4000)), 0.0F);
  EXPECT_EQ(clock.stretched(), Nanoseconds(0));
}

TEST(PacedClock, SleepsNoShorterThanAsked) {
  const Nanoseconds until = monotonicNow() + milliseconds(3);
  sleepUntil(until);
  EXPECT_GE(monotonicNow(), until);
  sleepUntil(monotonicNow() - milliseconds(3));  // past: returns
}

TEST(CostHistogram, MeanAndQuantiles) {
  CostHistogram cost;
  EXPECT_EQ(cost.mean(), 0.0);
  EXPECT_EQ(cost.quantile(0.999), 0.0);
  for (int i = 0; i < 998; ++i) cost.add(microseconds(3));
  cost.add(microseconds(40));
  cost.add(milliseconds(9));
  EXPECT_EQ(cost.count(), 1000U);
  EXPECT_NEAR(cost.mean(), (998 * 3e-6 + 40e-6 + 9e-3) / 1000, 1e-12);
  EXPECT_NEAR(cost.quantile(0.5), 3.25e-6, 1e-12);
  EXPECT_NEAR(cost.quantile(0.999), 40.25e-6, 1e-12);
  EXPECT_NEAR(cost.quantile(1.0), 9e-3, 1e-12);
  EXPECT_NEAR(cost.largest(), 9e-3, 1e-12);
}

}  // namespace
}  // namespace calot::recorder

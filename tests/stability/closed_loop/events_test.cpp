// SPDX-License-Identifier: GPL-3.0-or-later
// The force where a device appears, disappears, is clutched, is not commanded any more, and where an attempt ends.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/stability/closed_loop/support/closed_loop.h"

namespace calot {
namespace {

using recorder::ForceOutput;
using test::ClosedLoop;
using test::LoopSettings;

constexpr double largestChange = 0.001 * ForceOutput::maxSlew + 1e-9;  // N a tick

/// A hand that presses on a spring (200 N/m from 0 on) by up to 20 mm within 0.2 s: about 1.5 N.
struct Held {
  explicit Held(int delay = 2) : loop(settingsOf(delay)) {}
  static LoopSettings settingsOf(int delay) {
    LoopSettings out;
    out.delay = delay;
    return out;
  }
  void run(int ticks, double intended = 0.02) {
    const Vec3 from = way;
    for (int k = 1; k <= ticks; ++k) {
      const double share = std::min(1.0, k / 200.0);
      way = from + share * (Vec3(0.0, intended, 0.0) - from);
      const double depth = loop.position().y();
      loop.tick(Vec3(0.0, depth > 0.0 ? -200.0 * depth : 0.0, 0.0), way);
    }
  }
  ClosedLoop loop;
  Vec3 way = Vec3::Zero();
};

TEST(ForceEvents, AppearingRisesWithoutAJump) {
  Held held;
  held.loop.silent = true;
  held.run(1500, 0.01);
  EXPECT_EQ(held.loop.sent().norm(), 0.0);
  held.loop.silent = false;
  held.run(1);
  EXPECT_LE(held.loop.sent().norm(), 0.05);
  held.run(1500, 0.03);
  EXPECT_GT(held.loop.sent().norm(), 0.5);
  EXPECT_LE(held.loop.maxChange, largestChange);
}

TEST(ForceEvents, ClutchFallsWithinThirtyMillisecondsAndRisesAfter) {
  Held held;
  held.run(1500);
  const double before = held.loop.sent().norm();
  ASSERT_GT(before, 0.5);
  held.loop.clutched = true;
  held.run(40);
  EXPECT_EQ(held.loop.sent().norm(), 0.0);
  held.loop.clutched = false;
  held.run(1);
  EXPECT_LT(held.loop.sent().norm(), 0.1 * before);
  held.run(1500, 0.0);
  held.run(1500);
  EXPECT_GT(held.loop.sent().norm(), 0.5);
  EXPECT_LE(held.loop.maxChange, largestChange);
}

TEST(ForceEvents, AHiddenPoseAndAPausedSimulationLetTheForceFall) {
  for (const bool hidden : {true, false}) {
    Held held;
    held.run(1500);
    ASSERT_GT(held.loop.sent().norm(), 0.5);
    (hidden ? held.loop.hidden : held.loop.silent) = true;
    held.run(20 + 40);
    EXPECT_EQ(held.loop.sent().norm(), 0.0) << hidden;
    EXPECT_LE(held.loop.maxChange, largestChange);
  }
}

TEST(ForceEvents, TheEndOfAnAttemptLetsTheForceFall) {
  Held held;
  held.run(1500);
  held.loop.output().release();
  EXPECT_FALSE(held.loop.output().idle());
  held.run(40);
  EXPECT_TRUE(held.loop.output().idle());
  EXPECT_LE(held.loop.maxChange, largestChange);
}

TEST(ForceEvents, ALostDeviceBeginsAtZero) {
  Held held;
  held.run(1500);
  held.loop.output().lost();
  held.run(1);
  EXPECT_LE(held.loop.sent().norm(), largestChange);
  held.run(1500, 0.0);
  held.run(1500);
  EXPECT_GT(held.loop.sent().norm(), 0.5);
}

TEST(ForceEvents, NoCommandExceedsTheLimitOrIsNotFinite) {
  LoopSettings settings;
  settings.hand.maxForce = 3.3;
  ClosedLoop loop(settings);
  const double huge = std::numeric_limits<double>::max(), none = std::numeric_limits<double>::quiet_NaN();
  const Vec3 commands[] = {Vec3(100, -50, 3), Vec3(huge, huge, -huge), Vec3(none, 0, 0), Vec3(0, huge, none),
                           Vec3(3.3, 0, 0)};
  for (int k = 0; k < 5000; ++k) {
    loop.tick(commands[(k / 50) % 5], Vec3(0.02 * std::sin(0.01 * k), 0.0, 0.0));
    ASSERT_TRUE(loop.sent().allFinite());
    ASSERT_LE(loop.sent().norm(), 3.3);
    ASSERT_LE(loop.shown().norm(), 3.3);
  }
}

}  // namespace
}  // namespace calot

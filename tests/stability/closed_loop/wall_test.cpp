// SPDX-License-Identifier: GPL-3.0-or-later
// Walls through the whole loop: with and without ForceOutput, against theory, over stiffness, damping and delay.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/stability/closed_loop/support/z_width.h"

namespace calot {
namespace {

using recorder::EnergyTank;
using recorder::SimulatedHandModel;
using test::ClosedLoop;
using test::LoopSettings;

constexpr double stiffest = 20000.0;  // N/m

bool heavy() { return std::getenv("CALOT_HEAVY") != nullptr; }

/// A handle that nobody holds, struck within a spring: the worst hand for a force without a controller, and the one
/// that theory speaks of. @returns by how much its swing grows from one second to the next
double growth(const LoopSettings& settings, double stiffness) {
  ClosedLoop loop(settings);
  loop.hand().strike(Vec3(0.001, 0.0, 0.0));
  double before = 0.0;
  for (int k = 0; k < 3000; ++k) {
    if (k == 2000) before = loop.swing();
    if (k % 1000 == 0) loop.watch();
    loop.tick(-stiffness * loop.position(), Vec3::Zero());
  }
  return loop.swing() / before;
}

/// Without a controller the limit is the known one: b > K (T / 2 + delay), Colgate and Schenkel 1997 for delay 0.
TEST(Wall, WithoutPassivityTheLimitIsThatOfTheory) {
  for (const int delay : {0, 1, 3}) {
    LoopSettings settings;
    settings.hand = test::letGo();
    settings.hand.deviceFriction = 0.0;
    settings.hand.encoderQuantum = settings.hand.motorQuantum = 0.0;
    settings.hand.deviceDamping = 1.0;
    settings.hand.maxForce = 1e9;
    settings.passive = false;
    settings.delay = delay;
    const double expected = settings.hand.deviceDamping / (0.001 * (0.5 + delay));
    double low = 0.1 * expected, high = 10.0 * expected;
    while (high > 1.01 * low) {
      const double middle = std::sqrt(low * high);
      (growth(settings, middle) < 1.0 ? low : high) = middle;
    }
    std::printf("delay %d ms: stable up to %.0f N/m, by theory %.0f N/m\n", delay, low, expected);
    EXPECT_NEAR(low / expected, 1.0, 0.05) << delay;
  }
}

class WallOf : public testing::TestWithParam<int> {
 protected:
  static SimulatedHandModel hand() {
    if (GetParam() == 0) return test::letGo();
    return GetParam() == 1 ? SimulatedHandModel{} : test::firmGrip();
  }
};

TEST_P(WallOf, IsPassiveStillAndWithinTheLimitWhateverItsStiffnessAndDelay) {
  std::vector<double> stiffnesses{100.0, 1000.0, 5000.0};
  std::vector<double> dampings{0.0, 5.0};
  if (heavy()) {
    stiffnesses = {50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0, 20000.0};
    dampings = {0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
  }
  for (int delay = 0; delay <= 5; ++delay) {
    for (const double damping : dampings) {
      for (const double stiffness : stiffnesses) {
        LoopSettings settings;
        settings.hand = hand();
        settings.delay = delay;
        const test::WallRun run = test::pressWall(settings, stiffness, damping);
        const std::string what =
            "K " + std::to_string(stiffness) + ", B " + std::to_string(damping) + ", delay " + std::to_string(delay);
        EXPECT_LT(run.swing, test::stillSwing) << what;
        EXPECT_LE(run.given, EnergyTank::initial) << what;
        EXPECT_LE(run.maxShown, settings.hand.maxForce) << what;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Hands, WallOf, testing::Values(0, 1, 2));

/// Contact that comes and goes: the arm swings through the wall's surface; and a handle that is struck against it.
TEST(Wall, ContactThatComesAndGoesGivesNoEnergy) {
  for (const int delay : {0, 2, 5}) {
    for (const double stiffness : {500.0, 3000.0}) {
      LoopSettings settings;
      settings.delay = delay;
      ClosedLoop loop(settings);
      test::VirtualWall wall(stiffness, 0.0);
      for (int k = 0; k < 4000; ++k) {
        const double t = 0.001 * k;
        loop.tick(wall.force(loop.position() - Vec3(0.004, 0.0, 0.0)), Vec3(0.005 * std::sin(12.0 * t), 0.0, 0.0));
        if (k % 700 == 699) loop.hand().strike(Vec3(0.03, 0.01, 0.0));
      }
      EXPECT_LE(loop.maxGiven, EnergyTank::initial) << stiffness << " " << delay;
      EXPECT_LE(loop.maxSent, settings.hand.maxForce);
      EXPECT_GT(loop.maxShown, 0.1);
    }
  }
}

/// Without the controller the same walls swing: the suite can tell.
TEST(Wall, WithoutPassivityStiffWallsSwing) {
  LoopSettings settings;
  settings.passive = false;
  settings.delay = 5;
  EXPECT_GT(test::pressWall(settings, 5000.0, 0.0).swing, test::stillSwing);
  EXPECT_GT(test::pressWall(settings, 5000.0, 0.0).given, EnergyTank::initial);
}

/// The table of docs/explanation/forces.md; scripts/z_width.py runs it and draws it.
TEST(ZWidthHeavy, Table) {
  if (!heavy()) GTEST_SKIP() << "the whole table; with CALOT_HEAVY=1";
  for (const bool passive : {false, true}) {
    for (const double damping : {0.0, 2.0, 5.0, 10.0, 20.0}) {
      for (int delay = 0; delay <= 5; ++delay) {
        LoopSettings settings;
        settings.passive = passive;
        settings.delay = delay;
        const double widest = test::zWidth(settings, damping, stiffest);
        const test::WallRun run = test::pressWall(settings, widest, damping);
        const double organ = test::pressWall(settings, 300.0, damping).stiffness;
        std::printf("zwidth %d %g %d %.0f %.0f %.0f\n", passive ? 1 : 0, damping, delay, widest, run.stiffness, organ);
      }
    }
  }
}

}  // namespace
}  // namespace calot

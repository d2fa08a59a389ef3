// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_output.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "sim/math/random.h"

namespace calot::recorder {
namespace {

constexpr TankModel model{8.0, 0.3, 0.05, 0.0, 0.001};

/// Forces as large as the tank lets them be, by the worst hand that there can be: it moves so that each interval takes
/// the most.
TEST(EnergyTank, IsNeverNegativeWhateverTheHandAndTheDelay) {
  Random random(5, 1);
  for (const std::size_t delay : {0U, 1U, 3U, 10U}) {
    EnergyTank tank(model);
    std::deque<std::pair<std::uint32_t, double>> way(delay, {0U, 0.0});
    std::uint32_t number = 0;
    for (int k = 0; k < 5000; ++k) {
      const double force = random.uniform(0.2, 1.0) * tank.bound();
      tank.sent(++number, force);
      way.emplace_back(number, force);
      const auto [shown, effort] = way.front();
      way.pop_front();
      // Most is lost at (F - c) T / 2 b; now and then the hand pushes back, which fills the tank.
      const double b = EnergyTank::trusted * model.damping, c = EnergyTank::trusted * model.friction;
      double motion = std::max(0.0, effort - c) * model.period / (2.0 * b);
      if (random.uniform() < 0.3) motion = -random.uniform(0.0, 2e-4);
      tank.account(shown, Vec3(effort, 0, 0), Vec3(motion, 0, 0), model.period);
      ASSERT_GE(tank.level(), -1e-12) << "delay " << delay << ", tick " << k;
    }
    EXPECT_GE(tank.lowest(), -1e-12);
  }
}

TEST(EnergyTank, BoundAndReserveFitTogether) {
  EnergyTank tank(model);
  // A slow press fills it: 1 N over 3 mm.
  for (std::uint32_t n = 1; n <= 30; ++n) {
    tank.sent(n, 0.0);
    tank.account(n, Vec3(-1.0, 0, 0), Vec3(1e-4, 0, 0), model.period);
  }
  const double bound = tank.bound();
  EXPECT_GT(bound, 1.0);
  ASSERT_LT(bound, model.maxEffort);
  tank.sent(101, bound);
  EXPECT_NEAR(tank.reserved(), tank.level(), 1e-9);
  EXPECT_LT(tank.bound(), model.friction + 1e-3);
}

TEST(EnergyTank, WithoutDampingOnlyFrictionIsShown) {
  TankModel stiff = model;
  stiff.damping = 0.0;
  EnergyTank tank(stiff);
  EXPECT_NEAR(tank.bound(), EnergyTank::trusted * stiff.friction, 1e-12);
  stiff.friction = 0.0;
  EXPECT_EQ(EnergyTank(stiff).bound(), 0.0);
}

TEST(EnergyTank, FreeMotionStoresNothing) {
  EnergyTank tank(model);
  for (std::uint32_t n = 1; n <= 5000; ++n) {
    tank.sent(n, 0.0);
    tank.account(n, Vec3::Zero(), Vec3(5e-4, 0, 0), model.period);
    tank.settle(0.0);
  }
  EXPECT_LE(tank.level(), EnergyTank::initial);
}

}  // namespace
}  // namespace calot::recorder

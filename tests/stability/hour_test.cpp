// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated hour: hands press, hold and let go again and again. Nothing builds up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/sim/scene/support/loop.h"
#include "tests/stability/support/solid_checks.h"

namespace calot {
namespace {

constexpr double period = 4.0;  // s: pressed for two, left alone for two

/// @param seconds of simulated time
void pressAgainAndAgain(double seconds) {
  SceneDescription scene = test::blockScene(150, 5);
  scene.organs[0].material.massDamping = 0.5;
  scene.organs[0].material.stiffnessDamping = 0.005;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  const SolidModel& solid = model->organs()[0].solid;
  test::Loop loop(*model);
  const auto sample = [&](double t) {
    TickSamples tick = loop.resting();
    // Every round elsewhere, by an irrational part of a turn.
    const double round = std::floor(t / period);
    const double in = t - period * round;
    const double down = std::clamp(in < 1.0 ? 4.0 * in : 8.0 - 4.0 * in, 0.0, 1.0);
    for (std::size_t h = 0; h < handCount; ++h) {
      const double side = h == 0 ? -0.012 : 0.012;
      tick.hand[h].position = Vec3(side + 0.006 * std::sin(2.4 * round + static_cast<double>(h)),
                                   0.01 * std::cos(2.4 * round), 0.04 + down * (test::blockTop - 0.006 - 0.04));
      tick.hand[h].jaw = 0.5 * down;
    }
    return tick;
  };
  const auto rounds = static_cast<int>(seconds / period);
  const auto stepsOfRound = static_cast<int>(period / model->stepSeconds() + 0.5);
  double early = 0.0;  // largest energy while pressed, of the first ten rounds
  double late = 0.0;   // of all others
  double left = 0.0;   // largest at the end of a round
  double away = 0.0;   // displacement at the end of a round
  long missed = 0;
  for (int round = 0; round < rounds; ++round) {
    double largest = 0.0;
    for (int i = 0; i < stepsOfRound; ++i) {
      const StepResult& result = loop.step(sample, [] {});
      missed += result.misses != 0 ? 1 : 0;
      if (i % 20 == 0) {
        ASSERT_TRUE(test::allFinite(loop.rig.state)) << "round " << round;
        largest = std::max(largest, test::energy(solid, loop.rig.state.organ[0]));
      }
    }
    (round < 10 ? early : late) = std::max(round < 10 ? early : late, largest);
    left = std::max(left, test::energy(solid, loop.rig.state.organ[0]));
    away = std::max(away, loop.rig.state.organ[0].maxDisplacement);
  }
  std::printf(
      "%.0f s in %d rounds: energy at most %.2e J in the first ten, %.2e J later; %.1e J and %.1e mm left after a "
      "round; "
      "%ld of %d steps missed a tolerance\n",
      seconds, rounds, early, late, left, 1e3 * away, missed, rounds * stepsOfRound);
  EXPECT_GT(early, 1e-6) << "they press";
  EXPECT_LT(late, 1.5 * early);
  EXPECT_LT(left, 1e-4 * early);
  EXPECT_LT(away, 1e-4);
}

TEST(SimulatedHour, TwoMinutesOfIt) { pressAgainAndAgain(120.0); }

TEST(SimulatedHourHeavy, EnergyStaysBounded) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "set CALOT_HEAVY";
  pressAgainAndAgain(3600.0);
}

}  // namespace
}  // namespace calot

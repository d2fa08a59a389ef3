// SPDX-License-Identifier: GPL-3.0-or-later
// What the operator feels: forces without jumps, within the device's bounds, and no work out of nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/loop.h"

namespace calot {
namespace {

/// Part of the exchanged energy that contact sets of different steps may give out more than they take.
constexpr double epsilon = 0.02;

class HapticForces : public testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::buildModel(test::blockScene(500, 12)); }
  static void TearDownTestSuite() { model_.reset(); }
  void SetUp() override { ASSERT_TRUE(model_); }

  /// Runs the left hand along a path of (time) -> tip; the jaw likewise.
  template <class Path, class Jaw>
  static test::Felt run(double seconds, Path&& path, Jaw&& jaw, const char* what) {
    test::Loop loop(*model_);
    test::Felt felt;
    const auto sample = [&](double t) {
      TickSamples tick = loop.resting();
      tick.hand[0].position = path(t);
      tick.hand[0].jaw = jaw(t);
      return tick;
    };
    for (int step = 0; step < static_cast<int>(100.0 * seconds); ++step) {
      loop.step(sample, [&] { felt.take(loop.haptic[0], loop.force[0]); });
      EXPECT_TRUE(test::allFinite(loop.rig.state));
    }
    EXPECT_LE(felt.maxForce, model_->scene().hands[0].maxForce * (1.0 + 1e-12));
    std::printf("%s: largest jump %.4f N, largest force %.3f N, work on the operator %+.4f mJ of %.4f mJ exchanged\n",
                what, felt.maxJump, felt.maxForce, 1e3 * felt.work, 1e3 * felt.exchanged);
    return felt;
  }
  template <class Path>
  static test::Felt run(double seconds, Path&& path, const char* what) {
    return run(
        seconds, path, [](double) { return 0.0; }, what);
  }
  static inline std::unique_ptr<const Model> model_;
};

/// Down and up again at a constant speed: from `height` above the top to `depth` below it.
Vec3 pressAndRelease(double t, const Vec3& above, double depth, double speed) {
  const double way = above[2] - (test::blockTop - depth);
  const double s = std::min(speed * t, 2.0 * way);
  return above - Vec3(0.0, 0.0, s < way ? s : 2.0 * way - s);
}

TEST_F(HapticForces, ASlowPressAndReleaseHasNoJumps) {
  for (const Vec3& above : {Vec3(-0.010, 0.001, 0.017), Vec3(-0.0012, 0.0041, 0.017)}) {
    const test::Felt felt = run(
        0.8, [&](double t) { return pressAndRelease(t, above, 0.005, 0.02); }, "press and release at 20 mm/s");
    EXPECT_LT(felt.maxJump, 0.05);
    EXPECT_GT(felt.maxForce, 0.05);
  }
}

/// Along the top and over its edge: places of contact come and go.
TEST_F(HapticForces, SlidingOverAnEdgeHasNoJumps) {
  const test::Felt felt = run(
      2.2,
      [](double t) {
        const double down = std::min(1.0, t / 0.3);
        return Vec3(-0.010 - 0.02 * std::max(0.0, t - 0.3), 0.0013, 0.018 - 0.006 * down);
      },
      "sliding over an edge at 20 mm/s");
  EXPECT_LT(felt.maxJump, 0.05);
  EXPECT_GT(felt.maxForce, 0.05);
}

TEST_F(HapticForces, PullingHeldTissueHasNoJumps) {
  const test::Felt felt = run(
      1.6,
      [](double t) {
        const double down = std::min(1.0, t / 0.3);
        const double pull = t < 0.8 ? 0.0 : 0.02 * (t < 1.2 ? t - 0.8 : 1.6 - t);
        return Vec3(-0.009, 0.0013, 0.030 - 0.0145 * down + pull);
      },
      [](double t) { return t < 0.4 ? 0.6 : std::max(0.0, 0.6 - 2.0 * (t - 0.4)); }, "pulling held tissue at 20 mm/s");
  EXPECT_LT(felt.maxJump, 0.05);
  EXPECT_GT(felt.maxForce, 0.05);
}

/// Held tissue is let go: what the jaws had sunk into, and the pull, go within ticks, not at once.
TEST_F(HapticForces, LettingGoHasNoJumps) {
  for (const double lift : {0.002, 0.004}) {
    const test::Felt felt = run(
        1.8,
        [&](double t) {
          const double down = std::min(1.0, t / 0.3);
          const double pull = t < 0.8 ? 0.0 : std::min(lift, 0.02 * (t - 0.8));
          return Vec3(-0.009, 0.0013, 0.030 - 0.0145 * down + pull);
        },
        [](double t) {
          if (t > 1.2) return std::min(0.6, 2.0 * (t - 1.2));
          return t < 0.4 ? 0.6 : std::max(0.0, 0.6 - 2.0 * (t - 0.4));
        },
        "letting go of held tissue");
    EXPECT_LT(felt.maxJump, 0.01 + 0.12 * felt.maxForce);  // a tenth of what is left each tick
    EXPECT_GT(felt.maxForce, 0.02);
  }
}

/// A passive device gives back no more than it took: over closed paths it does no work on the operator.
TEST_F(HapticForces, PressingAndReleasingTakesWork) {
  for (const double speed : {0.005, 0.02, 0.05, 0.1, 0.2}) {
    const std::string what = "press at " + std::to_string(static_cast<int>(1e3 * speed)) + " mm/s";
    const test::Felt felt = run(
        0.02 / speed + 0.1, [&](double t) { return pressAndRelease(t, Vec3(-0.010, 0.001, 0.020), 0.005, speed); },
        what.c_str());
    EXPECT_LT(felt.work, epsilon * felt.exchanged) << "J";
  }
}

TEST_F(HapticForces, CirclesOnTheSurfaceTakeWork) {
  for (const double turns : {0.5, 2.0, 5.0}) {
    const std::string what = "circles at " + std::to_string(turns) + " Hz";
    const test::Felt felt = run(
        2.4,
        [&](double t) {
          const double press = std::min({1.0, t / 0.2, (2.4 - t) / 0.2});
          const double angle = 2.0 * std::numbers::pi * turns * t;
          return Vec3(-0.009 + 0.004 * std::cos(angle), 0.004 * std::sin(angle), 0.018 - 0.006 * press);
        },
        what.c_str());
    EXPECT_LT(felt.work, epsilon * felt.exchanged) << "J";
  }
}

/// Motion as of a hand that trembles: sums of waves up to 8 Hz with random phases.
TEST_F(HapticForces, RandomMotionTakesWork) {
  for (const std::uint64_t seed : {61U, 62U, 63U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::array<std::array<Vec3, 2>, 6> wave;
    for (auto& [a, b] : wave) {
      a = Vec3(random.normal(), random.normal(), random.normal());
      b = Vec3(random.normal(), random.normal(), random.normal());
    }
    const std::string what = "random motion, seed " + std::to_string(seed);
    const test::Felt felt = run(
        3.0,
        [&](double t) {
          Vec3 p(-0.009, 0.0, 0.016);
          for (std::size_t k = 0; k < wave.size(); ++k) {
            const double angle = 2.0 * std::numbers::pi * (0.7 + 1.4 * static_cast<double>(k)) * t;
            p += 0.0015 * (std::cos(angle) * wave[k][0] + std::sin(angle) * wave[k][1]);
          }
          const double away = std::min({1.0, t / 0.2, (3.0 - t) / 0.2});
          return Vec3(p + Vec3(0.0, 0.0, 0.02 * (1.0 - away)));
        },
        what.c_str());
    EXPECT_LT(felt.work, epsilon * felt.exchanged) << "J";
  }
}

}  // namespace
}  // namespace calot

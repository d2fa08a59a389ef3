// SPDX-License-Identifier: GPL-3.0-or-later
// A tracker's noise and rate: estimated from the samples, and never taken for what the hand did.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/motion.h"
#include "tests/support/message.h"

namespace calot::analytics::noise_test {
namespace {

constexpr unsigned seed = 43;

using Place = std::function<Vec3(double)>;

/// Reaches of one second, each followed by two of rest.
Vec3 reachAndRest(double t) {
  const auto stroke = static_cast<int>(t / 3.0);
  const double u = std::min(t - 3.0 * stroke, 1.0);
  const double s = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u), way = stroke % 2 == 0 ? s : 1.0 - s;
  return {0.05 * way, 0.02 * way, -0.03 * way};
}

/// Rows of a tracker of this rate and noise (m); `held` rows a second that repeat its newest sample, or 0.
recorder::TrackedMotion tracked(double rate, double noise, const Place& place, double held = 0.0, double seconds = 60.0,
                                unsigned hands = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise > 0.0 ? noise : 1.0);
  recorder::TrackedMotion motion;
  const double rows = held > 0.0 ? held : rate;
  for (int i = 0; i / rows <= seconds; ++i) motion.time.push_back(i / rows);
  for (unsigned h = 0; h < hands; ++h) {
    recorder::TrackedHand& hand = motion.hand[h];
    hand.present = true;
    hand.orientation.assign(motion.time.size(), Quat::Identity());
    double sampled = -1.0;
    for (const double t : motion.time) {
      const double at = std::floor(t * rate + 1e-9) / rate;
      if (at > sampled) {
        Vec3 p = place(at);
        for (int axis = 0; noise > 0.0 && axis < 3; ++axis) p[axis] += normal(random);
        hand.position.push_back(p);
      } else {
        hand.position.push_back(hand.position.back());
      }
      sampled = at;
    }
  }
  return motion;
}

CheckpointValue valueOf(const recorder::TrackedMotion& rows, const std::string& name,
                        const std::string& subject = "left") {
  for (CheckpointValue& v : valuesFromSamples(rows, {})) {
    if (v.name == name && v.subject == subject) return v;
  }
  ADD_FAILURE() << "no value of " << name;
  return {};
}

TEST(TrackerNoise, isThatOfTheSamplesAtEveryRate) {
  for (const double rate : {30.0, 60.0, 100.0, 250.0, 1000.0}) {
    for (const double noise : {5e-5, 1e-4, 2e-4, 5e-4}) {
      const Motion motion = motionOf(tracked(rate, noise, reachAndRest), 0);
      ASSERT_TRUE(motion.noise) << rate;
      EXPECT_NEAR(*motion.noise / noise, 0.93, 0.12) << rate << " Hz, " << noise << " m";
    }
    EXPECT_LT(motionOf(tracked(rate, 0.0, reachAndRest), 0).noise.value_or(0.0), 5e-5) << rate;
  }
}

TEST(TrackerNoise, isNotAHandThatTrembles) {
  // 4 mm at 4 Hz, without a moment of rest: motion, which a slow tracker sees in seven samples a period.
  const Place trembling = [](double t) {
    const double tremor = 0.004 * std::sin(25.0 * t);
    return Vec3(0.05 * std::sin(2.5 * t) + tremor, tremor, tremor);
  };
  EXPECT_LT(*motionOf(tracked(30.0, 0.0, trembling), 0).noise, 1e-4);
  EXPECT_NEAR(*motionOf(tracked(30.0, 3e-4, trembling), 0).noise, 3e-4, 1e-4);
}

TEST(TrackerNoise, isStoredBesideCoverage) {
  const CheckpointValue path = valueOf(tracked(30.0, 2e-4, reachAndRest), "path-length");
  EXPECT_EQ(path.coverage, 1.0);
  EXPECT_NEAR(path.rate.value_or(0.0), 30.0, 1e-9);
  EXPECT_NEAR(path.noise.value_or(0.0), 1.9e-4, 3e-5);
  const CheckpointValue absent = valueOf(tracked(30.0, 2e-4, reachAndRest), "path-length", "right");
  EXPECT_FALSE(absent.rate || absent.noise);
}

TEST(TrackerNoise, ofTheSpeedIsWhatTheFilterLeaves) {
  for (const double rate : {30.0, 60.0, 100.0, 400.0}) {
    const Motion motion = motionOf(tracked(rate, 2e-4, [](double) { return Vec3(0.1, 0.0, 0.0); }), 0);
    double squares = 0.0;
    for (const double v : motion.segments.front().speed) squares += v * v;
    const double measured = std::sqrt(squares / 3.0 / static_cast<double>(motion.points()));
    // Straight lines between slow samples leave a little less.
    EXPECT_NEAR(measured / speedNoise(motion), rate < 50.0 ? 0.95 : 1.05, 0.15) << rate;
  }
}

TEST(RepeatedRows, areNoSamples) {
  // A tracker of 30 Hz whose program writes 120 rows a second.
  const recorder::TrackedMotion own = tracked(30.0, 2e-4, reachAndRest),
                                repeated = tracked(30.0, 2e-4, reachAndRest, 120.0);
  EXPECT_NEAR(*valueOf(repeated, "motion-rate").value, 30.0, 1e-6);
  EXPECT_NEAR(*valueOf(repeated, "path-length").value / *valueOf(own, "path-length").value, 1.0, 0.01);
  EXPECT_NEAR(*valueOf(repeated, "path-length").noise / *valueOf(own, "path-length").noise, 1.0, 0.02);
  EXPECT_EQ(valueOf(repeated, "path-length").coverage, 1.0);
}

TEST(RepeatedRows, ofMoreThanATenthOfASecondAreRest) {
  const Place place = [](double t) { return Vec3(0.05 * std::min(std::max(t - 10.0, 0.0), 1.0), 0.0, 0.0); };
  const recorder::TrackedMotion rows = tracked(100.0, 0.0, place, 0.0, 20.0);
  EXPECT_NEAR(*valueOf(rows, "path-length").value, 0.05, 5e-4) << "the filter swings at both ends of the stroke";
  EXPECT_NEAR(*valueOf(rows, "idle-time").value, 19.0, 0.3);
  EXPECT_NEAR(*valueOf(rows, "motion-rate").value, 100.0, 1e-6);
}

TEST(Idle, isRefusedWhereNoiseFillsItsThreshold) {
  // 39.5 s of true rest, seen with little noise; and never a figure that noise has made.
  const double truth = *valueOf(tracked(100.0, 0.0, reachAndRest), "idle-time").value;
  for (const double rate : {30.0, 60.0, 100.0}) {
    for (const double noise : {0.0, 1e-4, 2e-4, 3e-4, 5e-4}) {
      const CheckpointValue idle = valueOf(tracked(rate, noise, reachAndRest), "idle-time");
      if (idle.value) {
        EXPECT_NEAR(*idle.value / truth, 1.0, 0.06) << rate << " Hz, " << noise << " m";
      } else {
        EXPECT_EQ(idle.availability, Availability::notAvailable);
        expectNames(idle.reason, {"noise", "5.0 mm/s"});
      }
      const bool borderline = rate == 100.0 && noise == 2e-4;
      EXPECT_TRUE(borderline || idle.value.has_value() == (noise < 1.5e-4)) << rate << " " << noise;
    }
  }
  const recorder::TrackedMotion both = tracked(30.0, 3e-4, reachAndRest, 0.0, 60.0, 2);
  EXPECT_EQ(valueOf(both, "idle-time-both", "").availability, Availability::notAvailable);
}

TEST(Paths, ofARestingHandAreNotItsTrackersNoise) {
  const recorder::TrackedMotion still = tracked(
      60.0, 2e-4, [](double) { return Vec3(0.1, 0.0, 0.0); }, 0.0, 60.0, 2);
  for (const char* name : {"path-length", "depth-path", "movements", "movement-jerk", "movement-straightness"})
    EXPECT_EQ(valueOf(still, name).availability, Availability::notAvailable) << name;
  for (const char* name : {"sparc", "log-dimensionless-jerk"}) EXPECT_FALSE(valueOf(still, name).value) << name;
  for (const char* name : {"hand-ratio", "bimanual-correlation", "bimanual-lag"})
    EXPECT_FALSE(valueOf(still, name, "").value) << name;
  // Along the shaft nothing moves, across it the hand does.
  const recorder::TrackedMotion across =
      tracked(60.0, 2e-4, [](double t) { return Vec3(0.05 * std::sin(t), 0.05 * std::cos(0.7 * t), 0.0); });
  EXPECT_TRUE(valueOf(across, "path-length").value);
  EXPECT_EQ(valueOf(across, "depth-path").availability, Availability::notAvailable);
}

TEST(Jerk, ofSteadyMotionHasNoValue) {
  const auto circle = [](double t) { return Vec3(0.05 * std::cos(2.0 * t), 0.05 * std::sin(2.0 * t), 0.0); };
  for (const Place& place : {Place(circle), Place([](double t) { return Vec3(0.01 * t, 0.0, 0.0); })}) {
    for (const double noise : {0.0, 1e-4}) {
      const CheckpointValue jerk = valueOf(tracked(100.0, noise, place, 0.0, 20.0), "log-dimensionless-jerk");
      EXPECT_EQ(jerk.availability, Availability::notApplicable) << noise;
      if (noise == 0.0) {
        expectNames(jerk.reason, {"steady"});
      }
    }
  }
  EXPECT_TRUE(valueOf(tracked(100.0, 0.0, reachAndRest), "log-dimensionless-jerk").value);
}

TEST(Lag, atTheEdgeOfTheSearchIsNone) {
  // The right hand follows by `lag`; beyond one second the greatest correlation lies at the edge.
  const auto lagOf = [](double lag) {
    const auto way = [](double t) { return Vec3(0.05 * std::sin(0.6 * t) * std::sin(0.25 * t), 0.0, 0.0); };
    recorder::TrackedMotion rows = tracked(100.0, 0.0, way, 0.0, 40.0, 2);
    for (std::size_t i = 0; i < rows.time.size(); ++i) rows.hand[1].position[i] = way(rows.time[i] - lag);
    return valueOf(rows, "bimanual-lag", "");
  };
  EXPECT_NEAR(lagOf(0.4).value.value_or(0.0), 0.4, 0.011);
  const CheckpointValue beyond = lagOf(1.6);
  EXPECT_EQ(beyond.availability, Availability::notApplicable);
  expectNames(beyond.reason, {"edge", "1 s"});
}

}  // namespace
}  // namespace calot::analytics::noise_test

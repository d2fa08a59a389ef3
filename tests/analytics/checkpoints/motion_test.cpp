// SPDX-License-Identifier: GPL-3.0-or-later
// Which ticks of a recording are samples of the tracker, and what is made of them.
#include "analytics/checkpoints/collector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "tests/analytics/checkpoints/support/steps.h"

namespace calot::analytics::motion_test {
namespace {

using support::feed;
using support::header;
using support::scene;
using support::valueOf;

const double pi = std::acos(-1.0);

/// A hand that reaches to and fro at about 60 mm/s in the mean.
Vec3 place(double t) {
  return {0.05 * std::sin(2.0 * t), 0.03 * std::sin(3.1 * t + 0.4), 0.1 + 0.02 * std::sin(1.3 * t + 1.0)};
}

/// What a tracker that measures `rate` times a second gives to ticks: its newest sample, held.
Motion held(double rate, double seconds, const std::function<Vec3(double)>& motion = place) {
  MotionTrack track(0.001);
  const int ticks = static_cast<int>(seconds * 1000.0);
  for (int tick = 0; tick < ticks; ++tick) {
    const double newest = std::floor(tick * 0.001 * rate + 1e-9) / rate;
    InstrumentSample s;
    s.position = motion(newest);
    track.add(s);
  }
  return track.motion();
}

double pathOf(const std::vector<Vec3>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

TEST(SamplesOfATracker, heldTicksAreNoSamples) {
  for (const double rate : {20.0, 30.0, 60.0, 100.0, 250.0, 1000.0}) {
    const Motion motion = held(rate, 30.0);
    EXPECT_NEAR(motion.rate, rate, 0.01 * rate) << "effective rate";
    ASSERT_EQ(motion.segments.size(), 1U) << rate;
    // A polygon through 20 points a second is shorter than these curves by less than a thousandth.
    EXPECT_NEAR(pathOf(motion.segments[0].filtered) / pathOf(held(1000.0, 30.0).segments[0].filtered), 1.0, 0.005)
        << rate;
  }
}

TEST(SamplesOfATracker, samplesThatDoNotMoveDoNotSlowTheTracker) {
  // Every fifth sample of a 30 Hz tracker is equal to the one before: a slow hand, rounded.
  MotionTrack track(0.001);
  for (int tick = 0; tick < 30000; ++tick) {
    const int sample = static_cast<int>(std::floor(tick * 0.03 + 1e-9));
    InstrumentSample s;
    s.position = place((sample % 5 == 0 ? sample - 1 : sample) / 30.0);
    track.add(s);
  }
  EXPECT_NEAR(track.motion().rate, 30.0, 0.3);
}

TEST(SamplesOfATracker, aHeldMotionHasNoStairs) {
  // Steps of a 30 Hz tracker, taken as measured every millisecond, would be jerks of 2 mm in a tick.
  const Motion motion = held(30.0, 20.0);
  const MotionSegment& s = motion.segments[0];
  double largest = 0.0;
  for (std::size_t i = 0; i < s.raw.size(); ++i) {
    const double t = 0.01 * static_cast<double>(s.first + static_cast<std::int64_t>(i));
    largest = std::max(largest, (s.raw[i] - place(t)).norm());
  }
  EXPECT_LT(largest, 0.0003) << "the straight line between samples, and not the last one held (which is 4 mm off)";
}

TEST(SamplesOfATracker, aPoseThatStandsForLongerIsRest) {
  // 30 Hz; a second of motion, two of rest (the source vouches for the pose), and motion again.
  const auto motion = [](double t) { return Vec3(0.1 * std::min(t, 1.0) + 0.1 * std::max(t - 3.0, 0.0), 0.0, 0.0); };
  const Motion m = held(30.0, 4.0, motion);
  ASSERT_EQ(m.segments.size(), 1U) << "rest is measured motion";
  const std::vector<Vec3>& raw = m.segments[0].raw;
  for (std::size_t i = 105; i < 296; ++i) EXPECT_NEAR(raw[i].x(), 0.1, 1e-12) << i;
  EXPECT_NEAR(m.rate, 30.0, 0.3);
  // The way out of rest begins one sampling interval before the first sample that shows it.
  for (std::size_t i = 300; i < 390; ++i)
    EXPECT_NEAR(raw[i].x(), motion(0.01 * static_cast<double>(i)).x(), 0.0005) << i;
}

TEST(SamplesOfATracker, aSourceThatMarksWhatItHoldsTooLongIsLost) {
  // A device that goes away for 1.2 s: its source holds the last pose for 0.1 s and then says "not measured".
  MotionTrack track(0.001);
  for (int tick = 0; tick < 4000; ++tick) {
    const bool away = tick >= 1500 && tick < 2700;
    InstrumentSample s;
    s.valid = !away || tick < 1600;
    s.position = place(0.001 * (away ? 1499 : tick));
    track.add(s);
  }
  const Motion motion = track.motion();
  ASSERT_EQ(motion.segments.size(), 2U);
  EXPECT_EQ(motion.segments[0].raw.size(), 150U) << "up to the last sample, tick 1499: not to what was held";
  EXPECT_EQ(motion.segments[1].first, 270);
  EXPECT_NEAR(lengthOf(motion.coverage.lost), 1.2, 1e-9);
}

TEST(SamplesOfATracker, rotationAloneIsASample) {
  MotionTrack track(0.001);
  for (int tick = 0; tick < 2000; ++tick) {
    const double angle = 0.001 * (tick / 20 * 20);
    InstrumentSample s;
    s.orientation = Quat(std::cos(angle / 2.0), 0.0, 0.0, std::sin(angle / 2.0));
    track.add(s);
  }
  EXPECT_NEAR(track.motion().rate, 50.0, 0.01);
}

TEST(SamplesOfATracker, rowsThatASourceInterpolatedAreTakenAsRows) {
  // A kinematics file's source draws a curve through 30 rows a second: 1000 poses that differ, 30 that were measured.
  MotionTrack track(0.001, 30.0);
  for (int tick = 0; tick < 20000; ++tick) {
    InstrumentSample s;
    s.position = place(0.001 * tick);
    track.add(s);
  }
  const Motion motion = track.motion();
  EXPECT_NEAR(motion.rate, 30.0, 0.01);
  recorder::AttemptHeader h = header();
  const auto rateOf = [&](recorder::OperatorKind kind, const std::string& device) {
    h.provenance.kind = kind;
    h.provenance.device = device;
    CheckpointCollector collector(h, scene());
    feed(collector, 500, [](std::uint64_t tick, TickSamples& s, recorder::TickOutcome&) {
      s.hand[0].position = place(0.001 * static_cast<double>(tick));
    });
    collector.onEnd(recorder::Outcome::stopped);
    return *valueOf(collector, "motion-rate", "left").value;
  };
  EXPECT_NEAR(rateOf(recorder::OperatorKind::kinematics, ""), 30.0, 0.1);
  EXPECT_NEAR(rateOf(recorder::OperatorKind::kinematics, "script"), 1000.0, 1e-6) << "a device holds; it doesn't draw";
  EXPECT_NEAR(rateOf(recorder::OperatorKind::human, "tracker"), 1000.0, 1e-6);
}

TEST(SamplesOfATracker, theMotionSoFarIsTheMotionOfSoMuch) {
  // Asking on the way changes nothing, and rest counts before it ends.
  MotionTrack asked(0.001), whole(0.001);
  for (int tick = 0; tick < 3000; ++tick) {
    InstrumentSample s;
    s.position = place(tick < 1000 ? 0.033 * std::floor(tick / 33) : 1.0);
    asked.add(s);
    whole.add(s);
    if (tick % 500 == 499) (void)asked.motion();
  }
  EXPECT_EQ(asked.motion().segments.size(), 1U);
  EXPECT_EQ(asked.motion().segments[0].filtered, whole.motion().segments[0].filtered);
  EXPECT_EQ(whole.motion().segments[0].raw.size(), 300U);
}

TEST(Cutoff, isAskedForAndNamed) {
  for (const double cutoff : motionCutoffs) {
    CheckpointCollector collector(header(), scene(), Origin::resimulated, cutoff);
    feed(collector, 1000, [](std::uint64_t tick, TickSamples& s, recorder::TickOutcome&) {
      const double t = 0.001 * static_cast<double>(tick);
      s.hand[0].position = place(t) + Vec3(0.002 * std::sin(2.0 * pi * 8.0 * t), 0.0, 0.0);
    });
    collector.onEnd(recorder::Outcome::stopped);
    const CheckpointValue path = valueOf(collector, "path-length", "left");
    EXPECT_EQ(path.filter, motionFilterText(cutoff));
    EXPECT_EQ(valueOf(collector, "motion-rate", "left").filter, "none");
    // A tremor of 8 Hz: 3 Hz takes it away, 10 Hz leaves most of it.
    double plain = 0.0;
    for (int i = 1; i < 1000; ++i) plain += (place(0.01 * i) - place(0.01 * (i - 1))).norm();
    if (cutoff == 3.0) {
      EXPECT_NEAR(*path.value, plain, 0.01 * plain);
    }
    if (cutoff == 10.0) {
      EXPECT_GT(*path.value, 1.03 * plain);
    }
  }
}

TEST(Noise, ofAFifthOfAMillimetreAt100HzIsFilteredAway) {
  // What was measured of real trials: such noise lengthens a path by 42 %, and the filter brings that to 0.1 %. A hand
  // at 44 mm/s in the mean, 100 samples a second; a path is noisy by chance, so the mean of eight seeds.
  const auto slow = [](double t) { return place(0.46 * t); };
  double raw = 0.0, filtered = 0.0, clean = 0.0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 0.0002);
    MotionTrack track(0.001);
    for (int tick = 0; tick < 60000; ++tick) {
      if (tick % 10 != 0) continue;
      const double x = noise(random), y = noise(random), z = noise(random);
      InstrumentSample s;
      s.position = slow(0.001 * tick) + Vec3(x, y, z);
      for (int repeat = 0; repeat < 10; ++repeat) track.add(s);
    }
    const MotionSegment segment = track.motion().segments[0];
    raw += pathOf(segment.raw);
    filtered += pathOf(segment.filtered);
    clean += pathOf(held(100.0, 60.0, slow).segments[0].filtered);
  }
  EXPECT_NEAR(raw / clean, 1.42, 0.03);
  EXPECT_NEAR(filtered / clean, 1.001, 0.0005);
}

}  // namespace
}  // namespace calot::analytics::motion_test

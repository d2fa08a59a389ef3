// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that are missing: planted over known motion, they are counted, bridged as declared, and decide nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/statistics/descriptive.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

constexpr unsigned seed = 23;

/// A hand that reaches, fetches and rests: 90 strokes of random length, way and duration, each of minimum jerk.
class Hand {
 public:
  explicit Hand(unsigned which) {
    std::mt19937 random(which);
    const auto uniform = [&](double from, double to) {
      return from + (to - from) * static_cast<double>(random()) / 4294967296.0;
    };
    double at = 0.5;
    Vec3 place = Vec3::Zero();
    for (int i = 0; i < 90; ++i) {
      Vec3 to;
      for (int axis = 0; axis < 3; ++axis) to[axis] = uniform(-0.02, 0.02);
      const double duration = uniform(0.25, 0.9);
      strokes_.push_back({at, duration, to - place});
      place = to;
      at += duration * uniform(0.4, 1.2);
    }
    end_ = at;
  }
  [[nodiscard]] Vec3 operator()(double t) const {
    Vec3 place = Vec3::Zero();
    for (const Stroke& s : strokes_) {
      const double u = std::clamp((t - s.start) / s.duration, 0.0, 1.0);
      place += u * u * u * (10.0 - 15.0 * u + 6.0 * u * u) * s.way;
    }
    return place;
  }
  [[nodiscard]] double end() const { return end_; }

 private:
  struct Stroke {
    double start, duration;
    Vec3 way;
  };
  std::vector<Stroke> strokes_;
  double end_ = 0.0;
};

using Place = std::function<Vec3(double)>;

/// Rows at these times, as a file of motion has them.
recorder::TrackedMotion rowsAt(const std::vector<double>& times, const Place& place) {
  recorder::TrackedMotion rows;
  recorder::TrackedHand& hand = rows.hand[0];
  hand.present = true;
  for (const double t : times) {
    rows.time.push_back(t - times.front());
    hand.position.push_back(place(t));
    hand.orientation.push_back(Quat::Identity());
  }
  return rows;
}

std::vector<double> clock(double rate, double seconds) {
  std::vector<double> times;
  for (int i = 0; i / rate <= seconds; ++i) times.push_back(i / rate);
  return times;
}

/// Without the rows within `count` gaps of `length`, spread by chance.
std::vector<double> withGaps(std::vector<double> times, int count, double length, std::mt19937& random) {
  const double spare = times.back() - 2.0 - count * (length + 0.3);
  EXPECT_GT(spare, 0.0);
  std::vector<double> at(static_cast<std::size_t>(count));
  for (double& t : at) t = spare * static_cast<double>(random()) / 4294967296.0;
  std::sort(at.begin(), at.end());
  for (int i = 0; i < count; ++i) {
    const double from = 1.0 + at[static_cast<std::size_t>(i)] + i * (length + 0.3);
    std::erase_if(times, [&](double t) { return t > from && t < from + length; });
  }
  return times;
}

CheckpointValue valueOf(const recorder::TrackedMotion& rows, const std::string& name,
                        const std::string& hand = "left") {
  for (CheckpointValue& v : valuesFromSamples(rows, {})) {
    if (v.name == name && v.subject == hand) return v;
  }
  ADD_FAILURE() << "no value of " << name;
  return {};
}

double numberOf(const recorder::TrackedMotion& rows, const std::string& name) {
  const CheckpointValue v = valueOf(rows, name);
  EXPECT_TRUE(v.value) << name << ": " << v.reason;
  return v.value.value_or(std::nan(""));
}

TEST(TimeSpans, agreeWithSetsOfTicks) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 200; ++round) {
    std::array<std::vector<bool>, 2> ticks{std::vector<bool>(60), std::vector<bool>(60)};
    std::array<TimeSpans, 2> spans;
    for (std::size_t s = 0; s < 2; ++s) {
      for (unsigned i = 0; i < 4; ++i) {
        const std::size_t from = random() % 60, to = std::min<std::size_t>(60, from + random() % 15);
        std::fill(ticks[s].begin() + static_cast<std::ptrdiff_t>(from),
                  ticks[s].begin() + static_cast<std::ptrdiff_t>(to), true);
        spans[s].push_back({static_cast<double>(from), static_cast<double>(to)});
      }
      spans[s] = normalized(spans[s]);
    }
    double both = 0.0, any = 0.0, left = 0.0, lost = 0.0;
    for (std::size_t i = 0; i < 60; ++i) {
      both += ticks[0][i] && ticks[1][i] ? 1.0 : 0.0;
      any += ticks[0][i] || ticks[1][i] ? 1.0 : 0.0;
      left += ticks[0][i] ? 1.0 : 0.0;
      lost += ticks[0][i] && i >= 20 && i < 30 ? 1.0 : 0.0;
    }
    EXPECT_EQ(lengthOf(intersection(spans[0], spans[1])), both);
    EXPECT_EQ(lengthOf(unionOf(spans[0], spans[1])), any);
    const MotionCoverage hand{spans[0], intersection(spans[0], {{20.0, 30.0}})};
    EXPECT_EQ(hand.share().has_value(), left > 0.0);
    if (left > 0.0) {
      EXPECT_DOUBLE_EQ(*hand.share(), 1.0 - lost / left);
    }
    const MotionCoverage part = coverageWithin(hand, {{25.0, 60.0}}), joint = ofBoth(hand, {spans[1], {}});
    EXPECT_EQ(lengthOf(part.lost), lengthOf(intersection(hand.lost, {{25.0, 60.0}})));
    EXPECT_EQ(lengthOf(joint.mounted), both);
    EXPECT_EQ(lengthOf(joint.lost), lengthOf(intersection(hand.lost, spans[1])));
  }
}

TEST(SampleRate, isThatOfTheClockForEvenUnevenAndBurstingStreams) {
  const auto measured = [](const std::vector<double>& times) {
    SampleRate rate;
    for (std::size_t i = 1; i < times.size(); ++i) rate.add(times[i] - times[i - 1]);
    return std::pair(rate.interval(), rate.hertz(GapRule{rate.interval()}.longestEven()));
  };
  for (const double rate : {1.0, 5.0, 9.9, 10.1, 30.0, 120.0, 1000.0}) {
    const auto [interval, hertz] = measured(clock(rate, 60.0));
    EXPECT_NEAR(hertz, rate, 1e-6 * rate);
    EXPECT_NEAR(interval, 1.0 / rate, 1e-9);
  }
  std::mt19937 random(seed);
  for (const double spread : {0.2, 0.5, 0.9}) {  // of the interval, either way
    std::vector<double> times = clock(10.1, 300.0);
    for (double& t : times) t += spread / 10.1 * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    EXPECT_NEAR(measured(times).second, 10.1, 0.05) << "spread " << spread << ", seed " << seed;
  }
  std::vector<double> bursts;
  for (int i = 0; i < 300; ++i) bursts.insert(bursts.end(), {0.1 * i, 0.1 * i + 0.001, 0.1 * i + 0.002});
  EXPECT_NEAR(measured(bursts).second, 30.0, 0.1) << "three rows in two milliseconds, ten times a second";
  EXPECT_NEAR(measured(bursts).first, 0.098, 1e-6) << "what lies between the bursts is not known";
  // A tracker that loses half of the time is one of 30 Hz that loses half of the time.
  const auto [interval, hertz] = measured(withGaps(clock(30.0, 60.0), 30, 0.9, random));
  EXPECT_NEAR(interval, 1.0 / 30.0, 1e-9);
  EXPECT_NEAR(hertz, 30.0, 1e-6);
}

TEST(Bridge, followsWhatItCannotSee) {
  // Constant speed: the curve is the line. A hand's motion: the error grows with the gap, and is small against the way.
  const std::vector<double> times = clock(60.0, 20.0);
  for (const double length : {0.12, 0.3, 0.6, 0.9}) {
    std::mt19937 random(seed);
    const std::vector<double> left = withGaps(times, 5, length, random);
    const Motion line = motionOf(rowsAt(left, [](double t) { return Vec3(0.1 * t, -0.05 * t, 0.0); }), 0);
    ASSERT_EQ(line.segments.size(), 1U) << length;
    for (std::size_t i = 0; i < line.segments[0].raw.size(); ++i)
      ASSERT_NEAR(line.segments[0].raw[i].x(), 0.001 * static_cast<double>(i), 1e-12) << length;
    double worst = 0.0, straight = 0.0;
    const Place way = [](double t) { return Vec3(0.05 * std::sin(2.0 * t), 0.03 * std::cos(3.0 * t), 0.0); };
    const Motion curve = motionOf(rowsAt(left, way), 0);
    for (std::size_t i = 0; i < curve.segments[0].raw.size(); ++i) {
      const double t = 0.01 * static_cast<double>(i);
      worst = std::max(worst, (curve.segments[0].raw[i] - way(t)).norm());
      const auto after = std::upper_bound(left.begin(), left.end(), t);
      if (after == left.end()) continue;
      const double a = *(after - 1), b = *after;
      straight = std::max(straight, (way(a) + (t - a) / (b - a) * (way(b) - way(a)) - way(t)).norm());
    }
    // Velocities are those of the middle of 0.1 s, which costs short gaps part of the gain.
    EXPECT_LT(worst, length < 0.2 ? straight : 0.5 * straight) << "against a straight line, gap " << length;
  }
}

TEST(Bridge, isWhatIsDeclared) {
  const Place way = [](double t) { return Vec3(0.05 * std::sin(2.0 * t), 0.0, 0.0); };
  const auto segments = [&](double rate, double gap) {
    std::vector<double> times = clock(rate, 30.0);
    std::erase_if(times, [&](double t) { return t > 10.0 + 1e-9 && t < 10.0 + gap - 1e-9; });
    return motionOf(rowsAt(times, way), 0).segments.size();
  };
  for (const double rate : {5.0, 10.0, 50.0}) {
    EXPECT_EQ(segments(rate, 1.0), 1U) << rate;
    EXPECT_EQ(segments(rate, 1.0 + 1.0 / rate), 1U) << "a second without samples, each covering its interval";
    EXPECT_EQ(segments(rate, 1.0 + 2.0 / rate), 2U) << rate;
  }
}

TEST(Coverage, isTheShareThatSamplesCover) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 20; ++round) {
    const double rate = 20.0 + 5.0 * static_cast<double>(random() % 20U);
    std::vector<double> times = clock(rate, 40.0);
    const std::size_t all = times.size();
    times = withGaps(std::move(times), 6, 0.2 + 0.05 * static_cast<double>(random() % 10U), random);
    // Each row that is gone took one interval with it.
    const double share = 1.0 - static_cast<double>(all - times.size()) / rate / times.back();
    EXPECT_NEAR(*motionOf(rowsAt(times, Hand(1)), 0).coverage.share(), share, 1e-9) << rate << " Hz";
  }
  EXPECT_EQ(*motionOf(rowsAt(clock(10.0, 40.0), Hand(1)), 0).coverage.share(), 1.0);
}

TEST(Coverage, belowWhatIsDeclaredThereIsNoFigure) {
  // A tenth of a second, and one row at the end.
  std::vector<double> times = clock(50.0, 0.12);
  times.push_back(27.4);
  const recorder::TrackedMotion rows = rowsAt(times, Hand(2));
  for (const CheckpointValue& v : valuesFromSamples(rows, {})) {
    const CheckpointDefinition& d = *findCheckpoint(v.name);
    if (d.minCoverage == 0.0) continue;
    EXPECT_FALSE(v.value) << v.name;
    if (v.subject == "left") {
      EXPECT_EQ(v.availability, Availability::tooLittleCoverage) << v.name;
      EXPECT_NEAR(*v.coverage, 0.005, 0.001);
      expectNames(v.reason, {"0.5 %"});
    } else {
      EXPECT_EQ(v.availability, Availability::absentHand) << v.name << " " << v.subject;
      EXPECT_FALSE(v.coverage);
    }
  }
  EXPECT_EQ(valueOf(rows, "attempt-duration", "").availability, Availability::value);
}

TEST(Coverage, ofTicksCountsWhatTheSourceMarks) {
  // 10 s: an instrument of 8 s; measured from 1 s on, lost for 0.5 s, away for the last 0.7 s. 100 Hz, held.
  MotionTrack track(0.001);
  for (int tick = 0; tick < 10000; ++tick) {
    InstrumentSample s;
    if (tick >= 8000) s.instrument = InstrumentKind::none;
    s.valid = tick >= 1000 && !(tick >= 4000 && tick < 4500) && tick < 7300;
    s.position = Hand(3)(0.001 * (tick - tick % 10));
    track.add(s);
  }
  const Motion motion = track.motion();
  EXPECT_NEAR(lengthOf(motion.coverage.mounted), 8.0, 1e-9);
  EXPECT_NEAR(lengthOf(motion.coverage.lost), 1.0 + 0.5 + 0.7, 0.02);
  ASSERT_EQ(motion.segments.size(), 1U) << "half a second is bridged";
}

TEST(SlowTracker, losesNothing) {
  const Hand hand(4);
  const double whole = numberOf(rowsAt(clock(100.0, hand.end()), hand), "path-length");
  // What ten samples a second see: the polygon.
  const Place polygon = [&](double t) {
    const double a = std::floor(t * 10.0 + 1e-9) / 10.0, b = a + 0.1;
    return Vec3(hand(a) + (t - a) / 0.1 * (hand(b) - hand(a)));
  };
  const double seen = numberOf(rowsAt(clock(100.0, hand.end()), polygon), "path-length");
  for (const double rate : {9.9, 10.0, 10.1}) {
    const recorder::TrackedMotion rows = rowsAt(clock(rate, hand.end()), hand);
    EXPECT_NEAR(numberOf(rows, "path-length") / seen, 1.0, 0.01) << rate;
    EXPECT_NEAR(numberOf(rows, "motion-rate"), rate, 1e-6);
    EXPECT_EQ(valueOf(rows, "log-dimensionless-jerk").availability, Availability::notAvailable);
  }
  EXPECT_GT(seen / whole, 0.85);
}

/// A tenth of the difference between published groups: docs/reference/metrics/samples.md, Gaps.
constexpr double sparcTolerance = 0.12, jerkTolerance = 0.2, pathTolerance = 0.02;

TEST(Smoothness, doesNotDependOnTheNumberOfGaps) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const auto& [count, length] : {std::pair{9, 0.16}, std::pair{4, 0.3}, std::pair{2, 0.46}}) {
    double sparc = 0.0, jerk = 0.0, path = 0.0;
    constexpr unsigned hands = 24;
    for (unsigned h = 0; h < hands; ++h) {
      const Hand hand(100 + h);
      const std::vector<double> times = clock(30.0, hand.end());
      const recorder::TrackedMotion whole = rowsAt(times, hand),
                                    gaps = rowsAt(withGaps(times, count, length, random), hand);
      sparc += numberOf(gaps, "sparc") - numberOf(whole, "sparc");
      const double change = numberOf(gaps, "log-dimensionless-jerk") - numberOf(whole, "log-dimensionless-jerk");
      EXPECT_LT(std::abs(change), 3.0 * jerkTolerance) << "hand " << h;
      jerk += change;
      path += numberOf(gaps, "path-length") / numberOf(whole, "path-length") - 1.0;
      expectNames(valueOf(gaps, "sparc").note, {"s"});
    }
    EXPECT_LT(std::abs(sparc / hands), sparcTolerance) << count << " gaps of " << length << " s";
    EXPECT_LT(std::abs(jerk / hands), jerkTolerance) << count << " gaps of " << length << " s";
    EXPECT_LT(std::abs(path / hands), pathTolerance) << count << " gaps of " << length << " s";
  }
}

TEST(Smoothness, isRefusedWhereAGapIsNotBridged) {
  const Hand hand(7);
  std::vector<double> times = clock(30.0, hand.end());
  std::erase_if(times, [](double t) { return t > 10.0 && t < 11.3; });
  const recorder::TrackedMotion rows = rowsAt(times, hand);
  for (const char* name : {"sparc", "log-dimensionless-jerk"}) {
    EXPECT_EQ(valueOf(rows, name).availability, Availability::tooLittleCoverage) << name;
    expectNames(valueOf(rows, name).reason, {"gap", "1 s"});
  }
  EXPECT_TRUE(valueOf(rows, "path-length").value) << "the rest of the way was measured";
}

TEST(Smoothness, spectralArcLengthIsRefusedWhereHalfASecondIsLostAtOnce) {
  const Hand hand(7);
  const auto lacking = [&](double from, double to) {
    std::vector<double> times = clock(30.0, hand.end());
    std::erase_if(times, [&](double t) { return t > from && t < to; });
    return rowsAt(times, hand);
  };
  const CheckpointValue refused = valueOf(lacking(10.0, 10.7), "sparc");
  EXPECT_EQ(refused.availability, Availability::tooLittleCoverage);
  expectNames(refused.reason, {"gap", "0.5 s"});
  EXPECT_TRUE(valueOf(lacking(10.0, 10.7), "log-dimensionless-jerk").value) << "it keeps its tolerance";
  EXPECT_TRUE(valueOf(lacking(10.0, 10.45), "sparc").value);
}

TEST(MovementThreshold, followsTheHand) {
  // The same hand at any scale has the same movements, down to speeds that are rest.
  const Hand hand(8);
  const std::vector<double> times = clock(60.0, hand.end());
  const recorder::TrackedMotion rows = rowsAt(times, hand);
  const double count = numberOf(rows, "movements"), straight = numberOf(rows, "movement-straightness");
  EXPECT_GT(count, 5.0);
  for (const double scale : {0.25, 0.5, 8.0}) {
    const recorder::TrackedMotion scaled = rowsAt(times, [&](double t) { return Vec3(scale * hand(t)); });
    EXPECT_EQ(numberOf(scaled, "movements"), count) << scale;
    EXPECT_NEAR(numberOf(scaled, "movement-straightness"), straight, 1e-9) << scale;
  }
  const recorder::TrackedMotion still = rowsAt(times, [&](double t) { return Vec3(0.01 * hand(t)); });
  EXPECT_EQ(numberOf(still, "movements"), 0.0);
  EXPECT_EQ(valueOf(still, "movement-jerk").availability, Availability::notApplicable);
  expectNames(valueOf(still, "movement-jerk").reason, {"5.0 mm/s", "0.2 s"});
  // No hand that moves lacks one, whatever its speed.
  for (unsigned h = 0; h < 40; ++h) {
    const Hand one(200 + h);
    const double slow = 0.2 + 0.05 * h;
    const recorder::TrackedMotion any = rowsAt(clock(30.0, one.end()), [&](double t) { return Vec3(slow * one(t)); });
    for (const char* name : {"movements", "movement-straightness", "movement-jerk"})
      EXPECT_TRUE(valueOf(any, name).value) << name << ", hand " << h;
  }
}

}  // namespace
}  // namespace calot::analytics

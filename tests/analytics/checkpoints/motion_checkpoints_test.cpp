// SPDX-License-Identifier: GPL-3.0-or-later
// Checkpoints of the hands' motion against values in closed form, and the defects of other tools that they must not
// have.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <random>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/motion.h"
#include "tests/analytics/checkpoints/support/steps.h"
#include "tests/support/message.h"

namespace calot::analytics::motion_checkpoints_test {
namespace {

using recorder::TickOutcome;
using support::feed;
using support::header;
using support::scene;
using support::valueOf;

const double pi = std::acos(-1.0);

using Hands = std::function<void(double t, InstrumentSample& left, InstrumentSample& right)>;

/// The values of an attempt in which both hands move as said, sampled every `every` ticks and held.
struct Attempt {
  Attempt(double seconds, const Hands& move, int every = 1, recorder::AttemptHeader h = header())
      : collector(h, scene()) {
    feed(collector, static_cast<std::uint64_t>(seconds * 100.0), [&](std::uint64_t tick, TickSamples& s, TickOutcome&) {
      const std::uint64_t sample = tick / static_cast<unsigned>(every) * static_cast<unsigned>(every);
      move(0.001 * static_cast<double>(sample), s.hand[0], s.hand[1]);
    });
    collector.onEnd(recorder::Outcome::completed);
  }
  [[nodiscard]] CheckpointValue value(const std::string& name, const std::string& subject = "") const {
    return valueOf(collector, name, subject);
  }
  [[nodiscard]] double number(const std::string& name, const std::string& subject = "") const {
    const CheckpointValue v = value(name, subject);
    EXPECT_TRUE(v.value) << name << " " << subject << ": " << v.reason;
    return v.value.value_or(-1e9);
  }
  CheckpointCollector collector;
};

Quat about(const Vec3& axis, double angle) {
  const Vec3 v = std::sin(angle / 2.0) * axis;
  return {std::cos(angle / 2.0), v.x(), v.y(), v.z()};
}

/// Minimum-jerk way from 0 to 1 in `duration` beginning at `start`.
double stroke(double t, double start, double duration) {
  const double s = std::clamp((t - start) / duration, 0.0, 1.0);
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

/// `count` strokes of 80 mm to and fro, 1 s each, one second apart, along `way`.
Vec3 strokes(double t, int count, const Vec3& way) {
  double at = 0.0;
  for (int i = 0; i < count; ++i) at += (i % 2 == 0 ? 1.0 : -1.0) * stroke(t, 1.0 + 2.0 * i, 1.0);
  return 0.08 * at * way;
}

TEST(Sparc, isRefusedForALongBridgeButNotForALateBeginning) {
  // Both hands lack 0.8 s of 30 s: the left one before its first sample, the right one amid its motion.
  const Attempt a(30.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
    left.position = right.position = strokes(t, 14, Vec3(1.0, 0.0, 0.0));
    left.valid = t >= 0.8;
    right.valid = t < 15.0 || t >= 15.8;
  });
  EXPECT_TRUE(a.value("sparc", "left").value) << a.value("sparc", "left").reason;
  expectNames(a.value("sparc", "right").reason, {"gap", "0.5 s"});
}

TEST(DepthPath, countsTheWayAlongTheShaftAlone) {
  // The shaft points along (0.6, 0, 0.8); the tip goes round a circle about it and in and out along it.
  const Quat tilt = about(Vec3(0.0, 1.0, 0.0), std::atan2(0.6, 0.8));
  const Vec3 z(0.6, 0.0, 0.8), x(0.8, 0.0, -0.6), y(0.0, 1.0, 0.0);
  const double radius = 0.02, depth = 0.015;
  const Attempt a(20.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
    left.orientation = right.orientation = tilt;
    left.position = radius * (std::cos(t) * x + std::sin(t) * y) + depth * std::sin(0.5 * pi * t) * z;
    right.position = radius * (std::cos(t) * x + std::sin(t) * y);
  });
  // Five periods of 4 s: 4 depth each.
  EXPECT_NEAR(a.number("depth-path", "left"), 20.0 * depth, 0.01 * 20.0 * depth);
  EXPECT_NEAR(a.number("depth-path", "right"), 0.0, 1e-12);
  EXPECT_GT(a.number("path-length", "right"), 0.39);
}

TEST(AngularPath, isTheSumOfTheTurns) {
  const Vec3 axis = Vec3(1.0, 2.0, 2.0) / 3.0;
  const Attempt a(21.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
    left.orientation = about(axis, 0.5 * t);  // past half a turn: the quaternion's sign is of no account
    if (std::fmod(t, 1.0) < 0.5) left.orientation.coeffs() *= -1.0;
    right.orientation = about(Vec3(1.0, 0.0, 0.0), 0.3);
    right.position = Vec3(0.01 * t, 0.0, 0.0);
  });
  EXPECT_NEAR(a.number("angular-path", "left"), 0.5 * 20.99, 0.005 * 10.5);
  EXPECT_NEAR(a.number("angular-path", "right"), 0.0, 1e-9) << "a hand that doesn't turn";
}

TEST(Speed, meanAndPercentileOfAUniformAndAChangingMotion) {
  const Attempt a(30.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
    left.position = Vec3(0.04 * t, 0.03 * t, 0.0);
    right.position = Vec3(0.0, 0.1 * std::sin(0.4 * pi * t), 0.0);  // speed 0.04 pi |cos|
  });
  EXPECT_NEAR(a.number("speed-mean", "left"), 0.05, 1e-5);
  EXPECT_NEAR(a.number("speed-p95", "left"), 0.05, 1e-4);
  EXPECT_NEAR(a.number("speed-mean", "right"), 0.08, 0.01 * 0.08);  // 2/pi of the peak
  // |cos| is above sin(0.95 pi / 2) in 5 % of the time.
  EXPECT_NEAR(a.number("speed-p95", "right"), 0.04 * pi * std::sin(0.95 * pi / 2.0), 0.001);
}

/// A defect of an open tool: movements found on another velocity than the tip's speed. Here they are the same along any
/// direction, for either hand, and nothing that the other hand does counts.
TEST(Movements, areFoundOnTheSpeedWhateverItsDirection) {
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, -1), Vec3(-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0)}) {
    const Attempt a(16.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
      left.position = strokes(t, 7, way);
      right.position = 0.01 * strokes(t, 3, way);
    });
    EXPECT_EQ(a.number("movements", "left"), 7.0) << way.transpose();
    EXPECT_EQ(a.number("movements", "right"), 0.0) << "slower than 50 mm/s";
    // Mean speed of a stroke 80 mm/s, between them rest: 9 s and what is slow of each stroke.
    EXPECT_NEAR(a.number("idle-time", "left"), 9.0, 7 * 0.25);
    EXPECT_NEAR(a.number("idle-time", "right"), 16.0, 1e-9) << "0.8 mm strokes are rest";
    EXPECT_NEAR(a.number("idle-time-both"), a.number("idle-time", "left"), 1e-9);
  }
}

TEST(Movements, thresholdsAreThoseThatAreDeclared) {
  const auto movements = [](double speed, double seconds) {
    // A constant speed for so long; the filter rounds the corners by a few hundredths of a second.
    return Attempt(4.0,
                   [&](double t, InstrumentSample& left, InstrumentSample&) {
                     left.position = Vec3(speed * std::clamp(t - 2.0, 0.0, seconds), 0.0, 0.0);
                   })
        .number("movements", "left");
  };
  // Half of the hand's 95th percentile, at least 5 mm/s.
  EXPECT_EQ(movements(0.0055, 0.8), 1.0);
  EXPECT_EQ(movements(0.0045, 0.8), 0.0);
  EXPECT_EQ(movements(0.08, 0.30), 1.0);
  EXPECT_EQ(movements(0.08, 0.05), 0.0) << "shorter than 0.2 s";
}

/// A defect of an open tool: the inefficiency of a closed path divides by its chord, zero.
TEST(MovementStraightness, ofAClosedPathIsZeroAndNoError) {
  const Attempt a(10.0, [](double t, InstrumentSample& left, InstrumentSample& right) {
    const double angle = 2.0 * pi * stroke(t, 2.0, 3.0);  // one whole turn: a single movement back to its start
    left.position = Vec3(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.0);
    right.position = strokes(t, 4, Vec3(0.0, 1.0, 0.0));
  });
  EXPECT_EQ(a.number("movements", "left"), 1.0);
  EXPECT_LT(a.number("movement-straightness", "left"), 0.2) << "the ends of the turn below the threshold are cut off";
  EXPECT_GE(a.number("movement-straightness", "left"), 0.0);
  EXPECT_NEAR(a.number("movement-straightness", "right"), 1.0, 1e-9);
  const Attempt still(3.0, [](double, InstrumentSample&, InstrumentSample&) {});
  EXPECT_EQ(still.value("movement-straightness", "left").availability, Availability::notApplicable);
}

/// A defect of an open tool: smoothness that grows with the duration. Of the whole attempt LDLJ does too (it falls by
/// 4 ln n for n times the same), which is why there is one of the movements.
TEST(MovementJerk, doesNotGrowWithTheNumberOfMovements) {
  const auto of = [](int count) {
    return Attempt(2.0 * count + 2.0, [count](double t, InstrumentSample& left, InstrumentSample&) {
      left.position = strokes(t, count, Vec3(0.0, 0.0, 1.0));
    });
  };
  const Attempt few = of(2), many = of(16);
  EXPECT_EQ(many.number("movements", "left"), 16.0);
  EXPECT_NEAR(many.number("movement-jerk", "left"), few.number("movement-jerk", "left"), 0.01);
  EXPECT_NEAR(many.number("movement-jerk", "left"), -std::log(204.8), 0.8)
      << "the smoothest there is; its ends below 5 mm/s, a tenth of its duration each, are cut off";
  EXPECT_LT(many.number("log-dimensionless-jerk", "left"), few.number("log-dimensionless-jerk", "left") - 6.0);
}

TEST(Jerk, isRefusedBelow30Hz) {
  const Hands move = [](double t, InstrumentSample& left, InstrumentSample&) {
    left.position = strokes(t, 3, Vec3(1.0, 0.0, 0.0));
  };
  const Attempt fast(8.0, move, 33), slow(8.0, move, 40), slower(8.0, move, 66);
  for (const char* name : {"log-dimensionless-jerk", "movement-jerk"}) {
    EXPECT_TRUE(fast.value(name, "left").value) << name;
    EXPECT_EQ(slow.value(name, "left").availability, Availability::notAvailable);
    expectNames(slow.value(name, "left").reason, {"25.0 Hz", "30 Hz"});
  }
  EXPECT_TRUE(slow.value("sparc", "left").value);
  expectNames(slower.value("sparc", "left").reason, {"15.2 Hz", "20 Hz"});
  EXPECT_TRUE(slower.value("path-length", "left").value);
}

TEST(Smoothness, ofAHandAtRestIsNoQuestion) {
  const Attempt a(5.0, [](double, InstrumentSample&, InstrumentSample&) {});
  for (const char* name : {"sparc", "log-dimensionless-jerk", "movement-jerk", "motion-rate"}) {
    EXPECT_EQ(a.value(name, "left").availability, Availability::notApplicable) << name;
  }
  EXPECT_NEAR(a.number("working-volume", "left"), 0.0, 1e-20);
  EXPECT_NEAR(a.number("idle-time", "left"), 5.0, 1e-9);
}

/// A defect of an open tool: a bimanual product that is multiplied by its own accumulator, and so always 0.
TEST(Bimanual, correlationAndLagOfHandsThatGoTogether) {
  const auto way = [](double t) { return 0.05 * std::sin(1.7 * t) + 0.02 * std::sin(4.1 * t + 1.0); };
  const auto attempt = [&](double lag) {
    return Attempt(40.0, [&, lag](double t, InstrumentSample& left, InstrumentSample& right) {
      left.position = Vec3(way(t), 0.0, 0.0);
      right.position = Vec3(0.0, 0.0, -0.5 * way(t - lag));
    });
  };
  const Attempt together = attempt(0.0);
  EXPECT_NEAR(together.number("bimanual-correlation"), 1.0, 1e-6);
  EXPECT_EQ(together.number("bimanual-lag"), 0.0);
  const Attempt follows = attempt(0.25), leads = attempt(-0.4);
  EXPECT_EQ(follows.number("bimanual-lag"), 0.25);
  EXPECT_EQ(leads.number("bimanual-lag"), -0.4);
  EXPECT_LT(follows.number("bimanual-correlation"), 0.9);
  expectNames(follows.value("bimanual-lag").note, {"1.000"});
}

TEST(Bimanual, ofHandsInTurnsIsNegativeAndOfOneHandNoQuestion) {
  const Attempt turns(40.0, [](double t, InstrumentSample& left, InstrumentSample& right) {
    const bool first = std::fmod(t, 4.0) < 2.0;
    const double s = std::fmod(t, 2.0) / 2.0, go = 0.05 * std::sin(pi * s) * std::sin(pi * s);
    (first ? left : right).position = Vec3(go, 0.0, 0.0);
  });
  EXPECT_LT(turns.number("bimanual-correlation"), -0.3);
  const Attempt never(40.0, [](double t, InstrumentSample& left, InstrumentSample& right) {
    (std::fmod(t, 20.0) < 10.0 ? left : right).position = Vec3(0.01 * std::sin(20.0 * t), 0.0, 0.0);
  });
  expectNames(never.value("bimanual-lag").reason, {"1 s"});
  EXPECT_NEAR(std::abs(turns.number("hand-ratio")), 0.5, 0.01);
  const Attempt one(
      10.0, [](double t, InstrumentSample& left, InstrumentSample&) { left.position = strokes(t, 3, Vec3(1, 0, 0)); });
  EXPECT_EQ(one.value("bimanual-correlation").availability, Availability::notApplicable);
  EXPECT_EQ(one.value("bimanual-lag").availability, Availability::notApplicable);
  EXPECT_NEAR(one.number("hand-ratio"), 0.0, 1e-12);
  const Attempt empty(
      10.0, [](double, InstrumentSample&, InstrumentSample& right) { right.instrument = InstrumentKind::none; });
  expectNames(empty.value("bimanual-correlation").reason, {"right hand"});
  expectNames(empty.value("hand-ratio").reason, {"right hand"});
}

TEST(HandRatio, isTheRightHandsShareAndNamesTheHandedness) {
  recorder::AttemptHeader h = header();
  h.handedness = "left";
  const Attempt a(
      20.0,
      [](double t, InstrumentSample& left, InstrumentSample& right) {
        left.position = Vec3(0.03 * t, 0.0, 0.0);
        right.position = Vec3(0.0, 0.01 * t, 0.0);
      },
      1, h);
  EXPECT_NEAR(a.number("hand-ratio"), 0.25, 1e-4);
  expectNames(a.value("hand-ratio").note, {"left"});
  const Attempt still(5.0, [](double, InstrumentSample&, InstrumentSample&) {});
  EXPECT_EQ(still.value("hand-ratio").availability, Availability::notApplicable);
}

TEST(WorkingVolume, isThatOfTheEllipsoid) {
  // Independent sines of incommensurable periods: covariance diag(a^2, b^2, c^2) / 2, whatever the frame.
  const double a = 0.04, b = 0.02, c = 0.01;
  const Quat turned = about(Vec3(1.0, 2.0, 2.0) / 3.0, 0.7);
  const Attempt attempt(400.0, [&](double t, InstrumentSample& left, InstrumentSample& right) {
    left.position = turned * Vec3(a * std::sin(t), b * std::sin(std::sqrt(2.0) * t), c * std::sin(std::sqrt(5.0) * t));
    right.position = Vec3(0.1 + 0.01 * std::sin(t), 0.02 * std::cos(1.5 * t), 0.3);  // in a plane
  });
  const double expected = 4.0 / 3.0 * pi * std::pow(7.814727903251179, 1.5) * a * b * c / std::pow(2.0, 1.5);
  EXPECT_NEAR(attempt.number("working-volume", "left") / expected, 1.0, 0.02);
  EXPECT_NEAR(attempt.number("working-volume", "right"), 0.0, 1e-12);
}

TEST(Phases, cutTheMotionAndAddUp) {
  CheckpointCollector collector(header(), support::sceneWithProcedure());
  // Identification 0 to 4 s, clipping to 6 s, identification again to 7 s, dissection to 10 s; 10 mm/s throughout, and
  // a second of rest in dissection. No cutting.
  support::feedPhases(
      collector, 1000,
      [](std::uint64_t tick, TickSamples& s, TickOutcome&) {
        const double t = 0.001 * static_cast<double>(tick);
        s.hand[0].position = Vec3(0.01 * (std::min(t, 8.0) + std::max(t - 9.0, 0.0)), 0.0, 0.0);
      },
      [](std::uint64_t step) {
        return step < 400   ? Phase::identification
               : step < 600 ? Phase::clipping
               : step < 700 ? Phase::identification
                            : Phase::dissection;
      });
  collector.onEnd(recorder::Outcome::completed);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "phase-duration", "identification").value, 5.0);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "phase-duration", "clipping").value, 2.0);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "phase-duration", "cutting").value, 0.0);
  EXPECT_DOUBLE_EQ(*valueOf(collector, "phase-duration", "dissection").value, 3.0);
  // Two pairs of identification's points are none: its two pieces have 399 + 99 pairs.
  EXPECT_NEAR(*valueOf(collector, "phase-path-length", "left identification").value, 0.01 * 4.98, 1e-6);
  EXPECT_NEAR(*valueOf(collector, "phase-path-length", "left clipping").value, 0.01 * 1.99, 1e-6);
  expectNames(valueOf(collector, "phase-path-length", "left cutting").reason, {"phase"});
  EXPECT_NEAR(*valueOf(collector, "phase-idle-time", "left dissection").value, 1.0, 0.1);
  EXPECT_EQ(*valueOf(collector, "phase-idle-time", "left clipping").value, 0.0);
  EXPECT_EQ(*valueOf(collector, "phase-movements", "left clipping").value, 1.0);
  expectNames(valueOf(collector, "phase-movements", "left clipping").note, {"5.0 mm/s"});
  EXPECT_EQ(valueOf(collector, "phase-path-length", "left clipping").origin, Origin::resimulated);
  const Attempt none(1.0, [](double, InstrumentSample&, InstrumentSample&) {});
  expectNames(none.value("phase-duration").reason, {"procedure"});
  expectNames(none.value("phase-path-length").reason, {"procedure"});
}

TEST(Force, impulseAndRateOfChange) {
  CheckpointCollector collector(header(), scene());
  // Left: grows by 2 N/s for 3 s along x, is held for 1 s, gone at once. Right: nothing.
  feed(collector, 600, [](std::uint64_t tick, TickSamples&, TickOutcome& o) {
    const double t = 0.001 * static_cast<double>(tick);
    if (t < 4.0) o.hand[0].force = Vec3(2.0 * std::min(t, 3.0), 0.0, 0.0);
  });
  collector.onEnd(recorder::Outcome::completed);
  EXPECT_NEAR(*valueOf(collector, "force-impulse", "left").value, 9.0 + 6.0, 0.01);
  EXPECT_NEAR(*valueOf(collector, "force-rate-p95", "left").value, 2.0, 1e-9);
  EXPECT_EQ(*valueOf(collector, "force-impulse", "right").value, 0.0);
  expectNames(valueOf(collector, "force-rate-p95", "right").reason, {"0.01 N"});
}

/// All motion checkpoints of a motion made of integers alone: the bits of every compiler and machine.
TEST(MotionCheckpoints, bitsAreThoseOfEveryCompilerAndMachine) {
  std::uint64_t state = 88172645463325252ULL;
  const auto next = [&] {
    state ^= state << 13U;
    state ^= state >> 7U;
    state ^= state << 17U;
    return static_cast<double>(static_cast<std::int64_t>(state >> 40U) - (1 << 23)) / static_cast<double>(1 << 23);
  };
  CheckpointCollector collector(header(), scene());
  std::array<Vec3, 2> p{Vec3::Zero(), Vec3::Zero()}, v{Vec3::Zero(), Vec3::Zero()};
  std::array<std::array<double, 4>, 2> q{{{1.0, 0.0, 0.0, 0.0}, {0.8, 0.6, 0.0, 0.0}}};
  feed(collector, 1500, [&](std::uint64_t tick, TickSamples& s, TickOutcome& o) {
    for (std::size_t h = 0; h < 2; ++h) {
      if (tick % 8 == 0) {
        for (int axis = 0; axis < 3; ++axis) {
          v[h][axis] = 0.96875 * v[h][axis] + 0.03125 * next();
          p[h][axis] += v[h][axis] / 256.0;
        }
        for (double& part : q[h]) part += next() / 64.0;
      }
      s.hand[h].position = p[h];
      s.hand[h].orientation = Quat(q[h][0], q[h][1], q[h][2], q[h][3]);
      o.hand[h].force = p[h] * 8.0;
    }
  });
  collector.onEnd(recorder::Outcome::completed);
  std::uint64_t mixed = 1469598103934665603ULL;
  std::size_t count = 0;
  for (const CheckpointValue& value : collector.values()) {
    const CheckpointDefinition& d = *findCheckpoint(value.name);
    if (d.filter != motionFilterText() && value.name.rfind("force", 0) != 0) continue;
    if (!value.value) continue;
    ++count;
    mixed ^= std::bit_cast<std::uint64_t>(*value.value);
    mixed *= 1099511628211ULL;
  }
  EXPECT_EQ(count, 38U);
  EXPECT_EQ(mixed, 0x86790f80aa89c407ULL) << std::hex << "0x" << mixed;
}

}  // namespace
}  // namespace calot::analytics::motion_checkpoints_test

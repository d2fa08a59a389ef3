// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals of nearness against a fine division of time, over random motions, and against closed forms.
#include "sim/geometry/dwell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/math/random.h"

namespace calot {
namespace {

Vec3 randomPoint(Random& random, double size) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = size * (2.0 * random.uniform() - 1.0);
  return p;
}

/// Share of [0, 1] in which `inside` holds, by counting.
template <class Inside>
double counted(const Inside& inside) {
  constexpr int parts = 4000;
  int found = 0;
  for (int i = 0; i < parts; ++i) found += inside((i + 0.5) / parts) ? 1 : 0;
  return static_cast<double>(found) / parts;
}

TEST(Dwell, OfAPointInACapsule) {
  Random random(11);
  int met = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Vec3 from = randomPoint(random, 2.0);
    const Vec3 way = randomPoint(random, 3.0);
    const Vec3 a = randomPoint(random, 1.0);
    const Vec3 b = trial % 10 == 0 ? a : randomPoint(random, 1.0);
    const double radius = 0.1 + random.uniform();
    const StepInterval when = insideCapsule(from, way, a, b, radius);
    const double share = when.empty() ? 0.0 : when.to - when.from;
    const double expected = counted([&](double t) {
      const Vec3 p = from + t * way;
      return (p - (a + closestOnSegment(p, a, b) * (b - a))).norm() <= radius;
    });
    EXPECT_NEAR(share, expected, 1e-3) << trial;
    met += share > 0.0 ? 1 : 0;
  }
  EXPECT_GT(met, 50);
}

TEST(Dwell, OfASegmentNearAnother) {
  Random random(12);
  int met = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Vec3 s0 = randomPoint(random, 1.0);
    const Vec3 s1 = trial % 7 == 0 ? s0 : randomPoint(random, 1.0);
    const Vec3 c0 = randomPoint(random, 1.0);
    const Vec3 c1 = trial % 11 == 0 ? Vec3(c0 + (s1 - s0)) : randomPoint(random, 1.0);  // parallel, too
    const Vec3 way = randomPoint(random, 4.0);
    const double radius = 0.05 + 0.4 * random.uniform();
    const StepInterval when = segmentsNear(s0, s1, c0, c1, way, radius);
    const double share = when.empty() ? 0.0 : when.to - when.from;
    const double expected = counted([&](double t) {
      const Vec3 off = (t - 0.5) * way;
      return closestSegments(s0 + off, s1 + off, c0, c1).squaredDistance <= radius * radius;
    });
    EXPECT_NEAR(share, expected, 1e-3) << trial;
    met += share > 0.0 ? 1 : 0;
  }
  EXPECT_GT(met, 50);
}

/// A wire that swings about its hinge by 29 degrees over a point: of second order in the angle.
TEST(Dwell, OfAWireThatTurns) {
  const auto end = [](double angle) { return Vec3(0.005 * std::cos(angle), 0.005 * std::sin(angle), 0.0); };
  const MovingPoint point{Vec3(0.004, 0.0, 0.0), Vec3(0.004, 0.0, 0.0)};
  double exact = 0.0;
  for (const int parts : {64, 8, 4, 2, 1}) {
    double sum = 0.0;
    for (int i = 0; i < parts; ++i) {
      const auto angle = [&](int k) { return -0.25 + 0.5 * k / parts; };
      const MovingCapsule wire{{Vec3::Zero(), end(angle(i))}, {Vec3::Zero(), end(angle(i + 1))}, 0.0006};
      const StepInterval when = near(wire, point, 0.0);
      if (!when.empty()) sum += (when.to - when.from) / parts;
    }
    if (parts == 64) exact = sum;
    EXPECT_NEAR(sum, exact, 0.03 * exact) << parts;
  }
  EXPECT_NEAR(exact, 2.0 * std::asin(0.0006 / 0.004) / 0.5, 1e-4);
}

TEST(Dwell, UnionsCountOnce) {
  StepIntervals intervals;
  EXPECT_EQ(intervals.length(), 0.0);
  intervals.add({0.5, 0.7});
  intervals.add({0.1, 0.2});
  intervals.add({0.6, 0.9});
  intervals.add({0.4, 0.3});  // empty
  intervals.add({0.65, 0.68});
  EXPECT_NEAR(intervals.length(), 0.5, 1e-15);
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/math/random.h"

namespace calot {
namespace {

Vec3 randomPoint(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

/// Least squared distance from p to the triangle by a search that shares nothing with the code: the distance is convex
/// over the triangle, so a grid that shrinks around its best point finds the least.
template <class Distance>
double minOverTriangle(const Distance& distance) {
  double best = 1e300;
  double u0 = 0.0, v0 = 0.0, width = 1.0;
  double cu = 0.5, cv = 0.5;
  for (int round = 0; round < 60; ++round) {
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        double u = std::clamp(cu + width * i / 4.0, 0.0, 1.0);
        double v = std::clamp(cv + width * j / 4.0, 0.0, 1.0);
        if (u + v > 1.0) {
          const double over = 0.5 * (u + v - 1.0);
          u = std::clamp(u - over, 0.0, 1.0);
          v = 1.0 - u;
        }
        const double d = distance(u, v);
        if (d < best) {
          best = d;
          u0 = u;
          v0 = v;
        }
      }
    }
    cu = u0;
    cv = v0;
    width *= 0.7;
  }
  return best;
}

TEST(ClosestOnTriangle, AgreesWithASearchAndIsConsistent) {
  Random random(20240601);
  int seen[7] = {};
  for (int trial = 0; trial < 3000; ++trial) {
    const Vec3 a = randomPoint(random), b = randomPoint(random), c = randomPoint(random);
    const Vec3 p = 2.0 * randomPoint(random);
    const PointTriangle r = closestOnTriangle(p, a, b, c);
    const double searched =
        minOverTriangle([&](double u, double v) { return (p - (a + u * (b - a) + v * (c - a))).squaredNorm(); });
    EXPECT_NEAR(std::sqrt(r.squaredDistance), std::sqrt(searched), 1e-6) << "trial " << trial;
    EXPECT_LE(r.squaredDistance, searched + 1e-14);
    EXPECT_GE(r.barycentric.minCoeff(), 0.0);
    EXPECT_NEAR(r.barycentric.sum(), 1.0, 1e-15);
    const Vec3 mixed = r.barycentric[0] * a + r.barycentric[1] * b + r.barycentric[2] * c;
    EXPECT_LT((mixed - r.point).norm(), 1e-14);
    ++seen[static_cast<int>(r.feature)];
    const int zeros = static_cast<int>((r.barycentric.array() == 0.0).count());
    const auto feature = static_cast<int>(r.feature);
    EXPECT_EQ(zeros, feature == 0 ? 0 : (feature < 4 ? 1 : 2));
    if (feature >= 4) {
      EXPECT_EQ(r.barycentric[feature - 4], 1.0);
    } else if (feature >= 1) {
      EXPECT_EQ(r.barycentric[(feature + 1) % 3], 0.0);
    }
  }
  for (const int count : seen) EXPECT_GT(count, 50);
}

TEST(ClosestOnTriangle, DegenerateTrianglesAreSegmentsAndPoints) {
  const Vec3 a(0.0, 0.0, 0.0), b(1.0, 0.0, 0.0), c(3.0, 0.0, 0.0);
  const PointTriangle line = closestOnTriangle({2.0, 1.0, 0.0}, a, b, c);
  EXPECT_NEAR(line.squaredDistance, 1.0, 1e-15);
  EXPECT_LT((line.point - Vec3(2.0, 0.0, 0.0)).norm(), 1e-15);
  const PointTriangle point = closestOnTriangle({0.0, 2.0, 0.0}, a, a, a);
  EXPECT_EQ(point.squaredDistance, 4.0);
  const PointTriangle sliver = closestOnTriangle({0.5, 1.0, 0.0}, a, c, {1.5, 1e-13, 0.0});
  EXPECT_NEAR(sliver.squaredDistance, 1.0, 1e-12);
}

TEST(ClosestSegments, AgreesWithASearch) {
  Random random(7);
  for (int trial = 0; trial < 3000; ++trial) {
    const Vec3 p0 = randomPoint(random), p1 = randomPoint(random), q0 = randomPoint(random);
    Vec3 q1 = randomPoint(random);
    if (trial % 5 == 0) q1 = q0 + random.uniform(-2.0, 2.0) * (p1 - p0);  // parallel
    if (trial % 50 == 1) q1 = q0;                                         // a point
    const SegmentSegment r = closestSegments(p0, p1, q0, q1);
    double best = 1e300;
    for (int i = 0; i <= 400; ++i) {
      const Vec3 x = p0 + (i / 400.0) * (p1 - p0);
      const double t = closestOnSegment(x, q0, q1);
      best = std::min(best, (x - (q0 + t * (q1 - q0))).squaredNorm());
    }
    EXPECT_LE(r.squaredDistance, best + 1e-14) << "trial " << trial;
    EXPECT_NEAR(std::sqrt(r.squaredDistance), std::sqrt(best), 0.01);
    EXPECT_LT((r.first - (p0 + r.s * (p1 - p0))).norm(), 1e-15);
    EXPECT_LT((r.second - (q0 + r.t * (q1 - q0))).norm(), 1e-15);
    EXPECT_EQ(r.squaredDistance, (r.first - r.second).squaredNorm());
    EXPECT_TRUE(r.s >= 0.0 && r.s <= 1.0 && r.t >= 0.0 && r.t <= 1.0);
  }
}

TEST(ClosestSegmentTriangle, AgreesWithASearchOverTheSegment) {
  Random random(99);
  int crossings = 0;
  int seen[7] = {};
  for (int trial = 0; trial < 4000; ++trial) {
    const Vec3 a = randomPoint(random), b = randomPoint(random), c = randomPoint(random);
    const Vec3 p0 = 1.5 * randomPoint(random), p1 = 1.5 * randomPoint(random);
    const SegmentTriangle r = closestSegmentTriangle(p0, p1, a, b, c);
    // The distance to a convex set is convex along the segment: golden section needs no derivative.
    double low = 0.0, high = 1.0;
    const auto at = [&](double s) { return closestOnTriangle(p0 + s * (p1 - p0), a, b, c).squaredDistance; };
    for (int i = 0; i < 80; ++i) {
      const double x = low + 0.382 * (high - low), y = low + 0.618 * (high - low);
      (at(x) < at(y) ? high : low) = at(x) < at(y) ? y : x;
    }
    const double searched = std::min({at(0.5 * (low + high)), at(0.0), at(1.0)});
    EXPECT_NEAR(std::sqrt(r.squaredDistance), std::sqrt(searched), 1e-6) << "trial " << trial;
    EXPECT_LE(r.squaredDistance, searched + 1e-14);
    EXPECT_GE(r.barycentric.minCoeff(), 0.0);
    EXPECT_NEAR(r.barycentric.sum(), 1.0, 1e-14);
    EXPECT_LT((r.onSegment - (p0 + r.parameter * (p1 - p0))).norm(), 1e-15);
    EXPECT_LT((r.onTriangle - (r.barycentric[0] * a + r.barycentric[1] * b + r.barycentric[2] * c)).norm(), 1e-9);
    EXPECT_EQ(r.crosses, r.squaredDistance == 0.0);
    crossings += r.crosses ? 1 : 0;
    ++seen[static_cast<int>(r.feature)];
  }
  EXPECT_GT(crossings, 100);
  for (const int count : seen) EXPECT_GT(count, 50);
}

TEST(ClosestSegmentTriangle, KnownCases) {
  const Vec3 a(0.0, 0.0, 0.0), b(1.0, 0.0, 0.0), c(0.0, 1.0, 0.0);
  const SegmentTriangle through = closestSegmentTriangle({0.25, 0.25, 1.0}, {0.25, 0.25, -3.0}, a, b, c);
  EXPECT_TRUE(through.crosses);
  EXPECT_EQ(through.parameter, 0.25);
  EXPECT_EQ(through.feature, TriangleFeature::face);
  const SegmentTriangle above = closestSegmentTriangle({0.2, 0.2, 0.5}, {0.3, 0.3, 0.7}, a, b, c);
  EXPECT_EQ(above.parameter, 0.0);
  EXPECT_NEAR(above.squaredDistance, 0.25, 1e-15);
  const SegmentTriangle beside = closestSegmentTriangle({0.5, -0.5, -1.0}, {0.5, -0.5, 1.0}, a, b, c);
  EXPECT_EQ(beside.feature, edgeFeature(0));
  EXPECT_NEAR(beside.squaredDistance, 0.25, 1e-15);
  EXPECT_NEAR(beside.parameter, 0.5, 1e-15);
  const SegmentTriangle corner = closestSegmentTriangle({-1.0, 1.0, 1.0}, {1.0, -1.0, 1.0}, a, b, c);
  EXPECT_NEAR(corner.squaredDistance, 1.0, 1e-15);
  const SegmentTriangle flat = closestSegmentTriangle({0.2, -1.0, 0.0}, {0.2, 2.0, 0.0}, a, b, c);
  EXPECT_NEAR(flat.squaredDistance, 0.0, 1e-30);
}

}  // namespace
}  // namespace calot

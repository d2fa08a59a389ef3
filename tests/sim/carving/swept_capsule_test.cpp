// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "sim/geometry/closest_point.h"
#include "sim/math/random.h"

namespace calot {
namespace {

Vec3 point(Random& random) {
  const double x = random.uniform(-1.0, 1.0);
  const double y = random.uniform(-1.0, 1.0);
  const double z = random.uniform(-1.0, 1.0);
  return {x, y, z};
}

/// The same distance without lanes: two triangles and, where these have no area, their sides.
double reference(const SweptCapsule& c, const Vec3& now, const Vec3& before) {
  const Vec3 shift = now - before;
  const Vec3 a = c.p0 + shift;
  const Vec3 b = c.p1 + shift;
  return std::sqrt(std::min(closestOnTriangle(now, a, b, c.q1).squaredDistance,
                            closestOnTriangle(now, a, c.q1, c.q0).squaredDistance));
}

struct Lanes {
  NodeLanes lanes{};
  Vec3 now[laneCount];
  Vec3 before[laneCount];

  explicit Lanes(Random& random, bool moving) {
    for (int i = 0; i < laneCount; ++i) {
      now[i] = point(random);
      before[i] = moving ? Vec3(now[i] + 0.3 * point(random)) : now[i];
      for (int k = 0; k < 3; ++k) {
        lanes.now[k][i] = now[i][k];
        lanes.before[k][i] = before[i][k];
        lanes.gradient[4 * k][i] = 1.0;
      }
    }
  }
};

TEST(SweptCapsule, DistanceIsThatToItsTwoTrianglesInEveryDegenerateCase) {
  Random random(9, 1);
  double worst = 0.0;
  for (int i = 0; i < 20000; ++i) {
    SweptCapsule c;
    c.radius = 0.1;
    c.p0 = point(random);
    c.p1 = point(random);
    c.q0 = point(random);
    c.q1 = point(random);
    const int kind = i % 8;
    if (kind == 1) c.q0 = c.p0, c.q1 = c.p1;                                      // at rest
    if (kind == 2) c.p1 = c.p0, c.q1 = c.q0;                                      // a sphere
    if (kind == 3) c.p1 = c.q0 = c.q1 = c.p0;                                     // a sphere at rest
    if (kind == 4) c.q0 = c.p0 + 0.7 * (c.p1 - c.p0), c.q1 = c.q0 + c.p1 - c.p0;  // along its axis
    if (kind == 5) c.q0 = c.p1;                                                   // a shared end
    if (kind == 6) c.q1 = c.p1;                                                   // turning about one end
    if (kind == 7) c.q0 = c.p1, c.q1 = c.p0;                                      // end for end
    const Lanes nodes(random, (i / 8) % 2 == 1);
    double out[laneCount];
    std::fill(out, out + laneCount, -1e300);
    ASSERT_TRUE(toolPotential({&c, 1}, nodes.lanes, 10.0, out));
    for (int k = 0; k < laneCount; ++k) {
      const double error = std::abs(c.radius - out[k] - reference(c, nodes.now[k], nodes.before[k]));
      worst = std::max(worst, error);
      ASSERT_LT(error, 1e-7) << "case " << kind << ", stroke " << i;
    }
  }
  std::cout << "seed 9: largest difference " << worst << "\n";
}

TEST(SweptCapsule, FarNodesAreLeftOutOnlyWhereTheyDoNotMatter) {
  Random random(10, 1);
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 from = 5.0 * point(random);
    SweptCapsule c{from, from + point(random), from + point(random), from + point(random), 0.2};
    Lanes nodes(random, true);
    for (auto& row : nodes.lanes.gradient) {
      for (double& g : row) g += random.uniform(-0.3, 0.3);
    }
    double all[laneCount];
    double some[laneCount];
    std::fill(all, all + laneCount, -1e300);
    std::fill(some, some + laneCount, -1e300);
    ASSERT_TRUE(toolPotential({&c, 1}, nodes.lanes, 1e3, all));
    const double reach = 0.5;
    if (toolPotential({&c, 1}, nodes.lanes, reach, some)) {
      for (int k = 0; k < laneCount; ++k) ASSERT_EQ(some[k], all[k]);
      continue;
    }
    ++far;
    for (const double v : all) ASSERT_LT(v, -reach);
  }
  EXPECT_GT(far, 1000);
}

TEST(SweptCapsule, PotentialIsADistanceInRestSpace) {
  // Tissue drawn out to twice its length along x: a tool that comes 1 mm near along x is 0.5 mm away at rest.
  const SweptCapsule c{{0.01, -1, 0}, {0.01, 1, 0}, {0.01, -1, 0}, {0.01, 1, 0}, 0.002};
  NodeLanes lanes{};
  for (int i = 0; i < laneCount; ++i) {
    const double rest = 0.0005 * i;
    lanes.now[0][i] = lanes.before[0][i] = 2.0 * rest;
    lanes.gradient[0][i] = 2.0;
    lanes.gradient[4][i] = 0.7;
    lanes.gradient[8][i] = 0.7;
  }
  double out[laneCount];
  std::fill(out, out + laneCount, -1e300);
  ASSERT_TRUE(toolPotential({&c, 1}, lanes, 1.0, out));
  // The surface of the tool lies at x = 8 mm, at rest 4 mm.
  for (int i = 0; i < laneCount; ++i) EXPECT_NEAR(out[i], 0.0005 * i - 0.004, 1e-15);
}

}  // namespace
}  // namespace calot

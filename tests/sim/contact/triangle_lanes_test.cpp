// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/triangle_lanes.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/math/random.h"

namespace calot {
namespace {

/// Points on a coarse lattice as often as not: coincident corners, parallel and touching edges, flat triangles.
Vec3 randomPoint(Random& random) {
  Vec3 p(random.normal(), random.normal(), random.normal());
  if (random.uniform() < 0.5) {
    for (int k = 0; k < 3; ++k) p[k] = static_cast<double>(static_cast<int>(2.0 * p[k]));
  }
  return 0.01 * p;
}

struct Case {
  std::vector<Vec3> position;
  ContactSurface surface;
  Vec3 p0;
  Vec3 p1;
};

Case randomCase(Random& random) {
  std::vector<Vec3> position(24);
  std::vector<Index3> triangle;
  const double size = random.uniform() < 0.1 ? 1e-9 : 1.0;
  for (std::size_t l = 0; l < 8; ++l) {
    const Vec3 centre = randomPoint(random);
    for (std::size_t k = 0; k < 3; ++k) position[3 * l + k] = centre + size * randomPoint(random);
    const double kind = random.uniform();
    if (kind < 0.1) position[3 * l + 1] = position[3 * l];
    if (kind > 0.05 && kind < 0.15) position[3 * l + 2] = position[3 * l];
    if (kind > 0.2 && kind < 0.3) position[3 * l + 2] = 0.5 * (position[3 * l] + position[3 * l + 1]);
    const int n = static_cast<int>(3 * l);
    triangle.emplace_back(n, n + 1, n + 2);
  }
  Case out{position, ContactSurface(position, triangle), randomPoint(random), randomPoint(random)};
  const double kind = random.uniform();
  if (kind < 0.1) out.p1 = out.p0;
  if (kind > 0.1 && kind < 0.2) out.p0 = position[3];
  if (kind > 0.2 && kind < 0.3) out.p1 = 0.5 * (position[6] + position[7]);
  if (kind > 0.3 && kind < 0.4) out.p1 = out.p0 + (position[10] - position[9]);  // parallel to an edge
  return out;
}

TEST(TriangleLanes, GiveTheBitsOfTheScalarFunctions) {
  SCOPED_TRACE("seed 301");
  Random random(301);
  int crossings = 0;
  int features[7] = {};
  for (int trial = 0; trial < 20000; ++trial) {
    const Case c = randomCase(random);
    const std::uint32_t all[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    TriangleLanes group;
    gatherTriangles(c.surface, c.position, all, group);
    LaneValues segment;
    LaneValues point;
    segmentTriangleDistances(group, c.p0, c.p1, segment);
    pointTriangleDistances(group, c.p0, point);
    for (std::size_t l = 0; l < 8; ++l) {
      const Index3& t = c.surface.triangles()[l];
      const auto at = [&](int k) -> const Vec3& { return c.position[static_cast<std::size_t>(t[k])]; };
      const SegmentTriangle s = closestSegmentTriangle(c.p0, c.p1, at(0), at(1), at(2));
      ASSERT_EQ(segment[l], s.squaredDistance) << "trial " << trial << " lane " << l;
      ASSERT_EQ(point[l], closestOnTriangle(c.p0, at(0), at(1), at(2)).squaredDistance)
          << "trial " << trial << " lane " << l;
      crossings += s.crosses ? 1 : 0;
      ++features[static_cast<int>(s.feature)];
    }
  }
  EXPECT_GT(crossings, 1000);
  for (const int n : features) EXPECT_GT(n, 1000) << "every kind of feature must have been met";
}

TEST(TriangleLanes, LeftOverLanesRepeatTheLast) {
  SCOPED_TRACE("seed 302");
  Random random(302);
  const Case c = randomCase(random);
  const std::uint32_t some[3] = {4, 1, 6};
  TriangleLanes group;
  gatherTriangles(c.surface, c.position, some, group);
  LaneValues squared;
  pointTriangleDistances(group, c.p0, squared);
  for (std::size_t l = 3; l < 8; ++l) EXPECT_EQ(squared[l], squared[2]);
}

TEST(TriangleLanes, ABoxKeepsEveryTriangleThatReachesIntoIt) {
  SCOPED_TRACE("seed 303");
  Random random(303);
  int kept = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Case c = randomCase(random);
    Box box;
    box.include(randomPoint(random));
    box.grow(0.008);
    std::array<std::uint32_t, ContactSurface::maxPatchTriangles> near{};
    const std::size_t count = trianglesInBox(c.surface, c.position, 0, box, near);
    kept += static_cast<int>(count);
    std::size_t next = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
      Box bounds;
      for (int k = 0; k < 3; ++k) {
        bounds.include(c.position[static_cast<std::size_t>(c.surface.triangles()[i][k])]);
      }
      if (!bounds.overlaps(box)) continue;
      ASSERT_LT(next, count);
      EXPECT_EQ(near[next++], i);
    }
    EXPECT_EQ(next, count);
  }
  EXPECT_GT(kept, 100);
}

}  // namespace
}  // namespace calot

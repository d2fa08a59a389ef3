// SPDX-License-Identifier: GPL-3.0-or-later
// The space between jaws: its planes, and what of a triangle lies in it.
#include "sim/instruments/instrument_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/math/random.h"

namespace calot {
namespace {

TEST(JawSpace, IsAWedgeFromTheHinge) {
  const InstrumentDefinition& grasper = instrument::grasper;
  const JawSpace space = jawSpace(grasper, nominalRadius, 0.010, 0.001);
  const double tip = std::tan(0.5 * grasper.jaw.opened) * grasper.jawLength;  // half of the opening at the tips
  EXPECT_TRUE(space.contains(Vec3::Zero()));
  EXPECT_TRUE(space.contains(Vec3(0.0, 0.99 * tip, 0.0)));
  EXPECT_FALSE(space.contains(Vec3(0.0, 1.01 * tip, 0.0)));
  EXPECT_FALSE(space.contains(Vec3(0.0, 0.7 * tip, -0.008))) << "jaws are narrower there";
  EXPECT_TRUE(space.contains(Vec3(0.00194, 0.0, -0.005)));
  EXPECT_FALSE(space.contains(Vec3(0.00196, 0.0, -0.005)));
  EXPECT_TRUE(space.contains(Vec3(0.0, 0.0, 0.0009)));
  EXPECT_FALSE(space.contains(Vec3(0.0, 0.0, 0.0011)));
  EXPECT_FALSE(space.contains(Vec3(0.0, 0.0, -0.0101)));
  // A shaft of 10 mm: all sizes twice.
  EXPECT_TRUE(jawSpace(grasper, 2.0 * nominalRadius, 0.010, 0.001).contains(Vec3(0.0038, 1.9 * tip, 0.0)));
}

/// Random triangles: the part inside has corners on the triangle and in the space, and misses no sampled point.
TEST(JawSpace, CutsTriangles) {
  Random random(21);
  const JawSpace space = jawSpace(instrument::grasper, nominalRadius, 0.0136, 0.001);
  JawSpace wider = space;
  wider.halfWidth += 1e-9;
  wider.slope += 1e-9;
  wider.back -= 1e-9;
  wider.front += 1e-9;
  int cut = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Vec3 corner[3];
    for (Vec3& p : corner)
      p = Vec3(random.uniform(-5e-3, 5e-3), random.uniform(-5e-3, 5e-3), random.uniform(-2e-2, 5e-3));
    if (trial % 9 == 0) corner[2] = corner[1];  // a segment
    const SmallPolygon part = between(space, corner[0], corner[1], corner[2]);
    for (std::size_t k = 0; k < part.count; ++k) {
      EXPECT_TRUE(wider.contains(part.corner[k])) << trial;
      EXPECT_LT(closestOnTriangle(part.corner[k], corner[0], corner[1], corner[2]).squaredDistance, 1e-22) << trial;
    }
    cut += part.count > 0 ? 1 : 0;
    for (int sample = 0; sample < 30; ++sample) {
      const double u = random.uniform();
      const double v = random.uniform() * (1.0 - u);
      const Vec3 p = (1.0 - u - v) * corner[0] + u * corner[1] + v * corner[2];
      if (!space.contains(p)) continue;
      ASSERT_GT(part.count, 0U) << trial;
      double nearest = 1e300;
      for (std::size_t k = 2; k < part.count; ++k) {
        nearest =
            std::min(nearest, closestOnTriangle(p, part.corner[0], part.corner[k - 1], part.corner[k]).squaredDistance);
      }
      EXPECT_LT(nearest, 1e-20) << trial;
    }
  }
  EXPECT_GT(cut, 300);
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Capsules whose axis is inside, thin parts, and the whole narrow phase against dense sampling of the distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/geometry/surface_distance.h"
#include "sim/math/elementary.h"
#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double thin = 0.0008;  // a hook's wire, generously

struct PlacedBody {
  SurfaceDescription skin;
  ContactSurface surface;
  std::vector<std::uint32_t> patches;

  explicit PlacedBody(SurfaceDescription s) : skin(std::move(s)), surface(skin.vertex, skin.triangle) {
    patches.resize(surface.patches().size());
    std::iota(patches.begin(), patches.end(), 0U);
  }
  [[nodiscard]] std::vector<SurfaceContact> contacts(const Vec3& p0, const Vec3& p1, double radius,
                                                     double reach) const {
    std::vector<SurfaceContact> out;
    capsuleContacts(surface, skin.vertex, patches, p0, p1, radius, reach, 2, out);
    return out;
  }
  [[nodiscard]] double gap(const Vec3& p0, const Vec3& p1, double radius, double reach) const {
    return minGap(surface, skin.vertex, patches, p0, p1, radius, reach);
  }
  [[nodiscard]] double distance(const Vec3& p) const {
    TriangleMesh mesh{skin.vertex, skin.triangle};
    if (!field) field = std::make_unique<SurfaceDistance>(std::move(mesh), InsideRule::pseudonormal);
    return field->signedDistance(p);
  }
  mutable std::unique_ptr<SurfaceDistance> field;
};

PlacedBody slab() {
  return PlacedBody(test::boxSurface(Vec3(-0.05, -0.05, -0.01), Vec3(0.05, 0.05, 0.01), {10, 10, 2}));
}
PlacedBody sheet() {
  return PlacedBody(test::boxSurface(Vec3(-0.05, -0.05, -0.001), Vec3(0.05, 0.05, 0.001), {10, 10, 1}));
}

/// A slab with waves on both sides: concave and convex edges and vertices everywhere.
PlacedBody waves() {
  SurfaceDescription s = test::boxSurface(Vec3(-0.04, -0.04, -0.008), Vec3(0.04, 0.04, 0.008), {12, 12, 2});
  for (Vec3& p : s.vertex) p[2] += 0.004 * sine(180.0 * p[0]) * cosine(150.0 * p[1]);
  return PlacedBody(s);
}

TEST(CapsuleDepth, AnAxisDeepBelowTheFaceIsFound) {
  const PlacedBody body = slab();
  for (const double depth : {1e-5, 0.0005, 0.0009, 0.002, 0.0049}) {
    for (const double side : {1.0, -1.0}) {
      const double z = side * (0.01 - depth);
      const Vec3 p0(0.0031, 0.0017, z);
      const Vec3 p1(0.0151, 0.0047, z);
      const std::vector<SurfaceContact> found = body.contacts(p0, p1, thin, 0.001);
      ASSERT_EQ(found.size(), 3U) << "both ends and the middle";
      for (const SurfaceContact& c : found) {
        EXPECT_LT((c.normal - side * Vec3::UnitZ()).norm(), 1e-9);
        EXPECT_NEAR(c.gap, -depth - thin, 1e-12);
      }
      EXPECT_NEAR(body.gap(p0, p1, thin, 0.001), -depth - thin, 1e-12);
    }
  }
  EXPECT_TRUE(body.contacts(Vec3(0.0, 0.0, 0.0049), Vec3(0.003, 0.0, 0.0049), thin, 0.001).empty())
      << "deeper than maxAxisDepth: stated not to be seen";
}

TEST(CapsuleDepth, ATipPushedInIsFoundHoweverDeep) {
  const PlacedBody body = slab();
  for (const double depth : {0.0005, 0.002, 0.0045, 0.008, 0.012}) {
    const Vec3 tip(0.0031, 0.0017, 0.01 - depth);
    const Vec3 back = tip + 0.025 * Vec3::UnitZ();
    for (const bool turned : {false, true}) {
      const std::vector<SurfaceContact> found =
          turned ? body.contacts(back, tip, thin, 0.001) : body.contacts(tip, back, thin, 0.001);
      ASSERT_GE(found.size(), 2U);
      double least = 0.0;
      for (const SurfaceContact& c : found) {
        least = std::min(least, c.gap);
        EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-9) << "never towards the other side";
      }
      EXPECT_NEAR(least, -std::min(depth, maxAxisDepth) - thin, 1e-12);
    }
  }
}

TEST(CapsuleDepth, AThinSheetIsNotMistakenForItsFarSide) {
  const PlacedBody body = sheet();
  for (const double z : {0.0013, 0.0017, 0.0019}) {
    for (const double side : {1.0, -1.0}) {
      const std::vector<SurfaceContact> found =
          body.contacts(Vec3(0.0031, 0.0017, side * z), Vec3(0.0151, 0.0047, side * z), 0.0025, 0.001);
      ASSERT_FALSE(found.empty());
      for (const SurfaceContact& c : found) {
        EXPECT_LT((c.normal - side * Vec3::UnitZ()).norm(), 1e-9);
        EXPECT_NEAR(c.gap, z - 0.001 - 0.0025, 1e-12);
      }
    }
  }
  for (const double z : {0.0002, 0.0006, 0.0009}) {
    for (const double side : {1.0, -1.0}) {
      const std::vector<SurfaceContact> found =
          body.contacts(Vec3(0.0031, 0.0017, side * z), Vec3(0.0151, 0.0047, side * z), thin, 0.001);
      ASSERT_EQ(found.size(), 3U);
      for (const SurfaceContact& c : found) {
        EXPECT_LT((c.normal - side * Vec3::UnitZ()).norm(), 1e-9) << "inside the sheet: the nearer side is the way out";
        EXPECT_NEAR(c.gap, -(0.001 - z) - thin, 1e-12);
      }
    }
  }
}

TEST(CapsuleDepth, AnAxisThroughACornerPartIsPushedOut) {
  const PlacedBody body = slab();
  // Through the edge at x = 0.05, z = 0.01, both ends outside, the middle 1 mm below the edge on the diagonal.
  const Vec3 middle(0.05 - 0.001, 0.0031, 0.01 - 0.001);
  const Vec3 along = Vec3(1.0, 0.0, -1.0).normalized();
  const std::vector<SurfaceContact> found = body.contacts(middle - 0.01 * along, middle + 0.01 * along, thin, 0.001);
  ASSERT_EQ(found.size(), 3U);
  int up = 0;
  int sideways = 0;
  for (const SurfaceContact& c : found) {
    up += (c.normal - Vec3::UnitZ()).norm() < 1e-9 ? 1 : 0;
    sideways += (c.normal - Vec3::UnitX()).norm() < 1e-9 ? 1 : 0;
    EXPECT_LT(c.gap, -thin + 1e-12);
  }
  EXPECT_EQ(up + sideways, 3);
  EXPECT_GE(up, 1);
  EXPECT_GE(sideways, 1);
}

TEST(CapsuleDepth, TouchingWithTheAxisIsAContact) {
  const PlacedBody body = slab();
  const Vec3 foot(0.0031, 0.0017, 0.01);
  for (const Vec3& back : {Vec3(0.0, 0.0, 0.02), Vec3(0.012, 0.0, 0.003)}) {
    const std::vector<SurfaceContact> found = body.contacts(foot, foot + back, thin, 0.0005);
    ASSERT_GE(found.size(), 1U);
    EXPECT_LT((found[0].normal - Vec3::UnitZ()).norm(), 1e-9);
    EXPECT_NEAR(found[0].gap, -thin, 1e-9);
  }
}

TEST(CapsuleDepth, BetweenTwoWallsBothPushAlike) {
  SurfaceDescription s = test::boxSurface(Vec3(-0.03, -0.02, -0.02), Vec3(-0.002, 0.02, 0.02), {4, 4, 4});
  const SurfaceDescription other = test::boxSurface(Vec3(0.002, -0.02, -0.02), Vec3(0.03, 0.02, 0.02), {4, 4, 4});
  const auto n = static_cast<int>(s.vertex.size());
  s.vertex.insert(s.vertex.end(), other.vertex.begin(), other.vertex.end());
  for (const Index3& t : other.triangle) s.triangle.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  const PlacedBody body(s);
  const std::vector<SurfaceContact> found =
      body.contacts(Vec3(0.0, 0.0031, 0.0), Vec3(0.0, 0.0031, 0.04), 0.0025, 0.001);
  double left = 0.0;
  double right = 0.0;
  for (const SurfaceContact& c : found) {
    EXPECT_NEAR(c.gap, -0.0005, 1e-12);
    EXPECT_NEAR(std::abs(c.normal[0]), 1.0, 1e-9);
    (c.normal[0] > 0.0 ? left : right) = std::min(c.normal[0] > 0.0 ? left : right, c.gap);
  }
  EXPECT_LT(left, 0.0);
  EXPECT_NEAR(left, right, 1e-15);
}

/// Sliding about: in the open the row's name stays while its feature does; inside it stays altogether.
TEST(CapsuleDepth, KeysStayAsTheCapsuleSlides) {
  const PlacedBody body = slab();
  std::vector<std::uint64_t> before;
  for (int i = 0; i <= 400; ++i) {
    const Vec3 tip(-0.03 + 1e-4 * i, 0.0031, 0.01 + 0.002);
    const std::vector<SurfaceContact> found = body.contacts(tip, tip + 0.02 * Vec3::UnitZ(), 0.0025, 0.001);
    ASSERT_EQ(found.size(), 1U) << i;
    if (before.empty() || before.back() != found[0].key) before.push_back(found[0].key);
  }
  EXPECT_LE(before.size(), 25U) << "one name a triangle crossed, and at most one an edge";
  std::sort(before.begin(), before.end());
  EXPECT_EQ(std::adjacent_find(before.begin(), before.end()), before.end()) << "no name comes back";
  std::vector<std::uint64_t> inside;
  for (int i = 0; i <= 400; ++i) {
    const Vec3 p0(-0.03 + 1e-4 * i, 0.0031, 0.01 - 0.001);
    std::vector<std::uint64_t> keys;
    for (const SurfaceContact& c : body.contacts(p0, p0 + Vec3(0.01, 0.003, 0.0), thin, 0.001)) keys.push_back(c.key);
    if (i == 0) inside = keys;
    ASSERT_EQ(keys, inside) << i;
  }
}

TEST(CapsuleDepth, TheGapFollowsTheMotionWithoutAJump) {
  const PlacedBody body = slab();
  for (const Vec3& axis : {Vec3(0.0, 0.0, 0.02), Vec3(0.012, 0.004, 0.0)}) {
    double before = 0.0;
    for (int i = 0; i <= 700; ++i) {
      const double height = 0.003 - 1e-5 * i;  // to 4 mm inside
      const Vec3 tip(0.0031, 0.0017, 0.01 + height);
      const double gap = body.gap(tip, tip + axis, thin, 0.004);
      EXPECT_NEAR(gap, height - thin, 1e-9);
      if (i > 0) {
        EXPECT_LT(std::abs(gap - before), 1.0001e-5);
      }
      before = gap;
    }
  }
}

/// Everything against the signed distance of the surface, sampled along the axis.
TEST(CapsuleDepth, AgreesWithDenseSamplingOfTheDistance) {
  std::vector<std::pair<std::string, PlacedBody>> bodies;
  bodies.emplace_back("waves", waves());
  bodies.emplace_back("sphere", PlacedBody(test::sphereSurface(Vec3(0.001, 0.002, 0.003), 0.015, 6)));
  bodies.emplace_back("sheet", sheet());
  SCOPED_TRACE("seed 311");
  Random random(311);
  constexpr double reach = 0.004;
  constexpr int samples = 200;
  int outside = 0;
  int crossing = 0;
  int inside = 0;
  for (const auto& entry : bodies) {
    const std::string& name = entry.first;
    const PlacedBody& body = entry.second;
    for (int trial = 0; trial < 300; ++trial) {
      const Vec3 centre(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-0.015, 0.02));
      const double length = random.uniform() < 0.1 ? 0.0 : random.uniform(0.001, 0.02);
      const Vec3 half = 0.5 * length * Vec3(random.normal(), random.normal(), random.normal()).normalized();
      const double radius = random.uniform(0.0005, 0.003);
      const Vec3 p0 = centre - half;
      const Vec3 p1 = centre + half;
      double least = 1e9;
      double most = -1e9;
      for (int k = 0; k <= samples; ++k) {
        const double d = body.distance(p0 + (p1 - p0) * k / samples);
        least = std::min(least, d);
        most = std::max(most, d);
      }
      const double step = length / samples;
      const double gap = body.gap(p0, p1, radius, reach);
      const std::vector<SurfaceContact> found = body.contacts(p0, p1, radius, reach);
      double leastFound = reach;
      for (const SurfaceContact& c : found) leastFound = std::min(leastFound, c.gap);
      ASSERT_NEAR(gap, leastFound, 1e-14) << name << " " << trial;
      const auto report = [&] { return name + " trial " + std::to_string(trial) + " gap " + std::to_string(gap); };
      if (least > step) {
        ++outside;
        const double expected = std::min(reach, least - radius);
        EXPECT_LE(gap, expected + 1e-12) << report();
        EXPECT_GE(gap, expected - step) << report();
      } else if (least < -step && least > -maxAxisDepth) {
        (most > 0.0 ? crossing : inside) += 1;
        ASSERT_FALSE(found.empty()) << report();
        EXPECT_LE(gap, -radius + 1e-12) << report();
        EXPECT_GE(gap, least - radius - step) << report();
        // The ends are among the rows, and they are what is deepest but for the bend of the surface in between.
        const double ends = std::min(body.distance(p0), body.distance(p1));
        if (ends < 0.0) {
          EXPECT_LE(gap, ends - radius + 1e-9) << report();
        }
      }
      for (const SurfaceContact& c : found) {
        const double at = body.distance(c.onAxis);
        EXPECT_NEAR(c.normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(c.weight.sum(), 1.0, 1e-9);
        EXPECT_GE(c.weight.minCoeff(), 0.0);
        Vec3 foot = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
          foot += c.weight[static_cast<int>(k)] * body.skin.vertex[static_cast<std::size_t>(c.node[k])];
        }
        if (c.gap > -radius + 1e-9) {
          EXPECT_GE(at, -1e-9) << report();
          EXPECT_GE(c.gap, at - radius - 1e-9) << report() << ": no nearer than the surface is";
          EXPECT_LT((foot + (c.gap + radius) * c.normal - c.onAxis).norm(), 1e-9) << report();
        } else if (at > -maxAxisDepth) {
          EXPECT_NEAR(c.gap, std::min(at, 0.0) - radius, 1e-8) << report();
        }
      }
    }
  }
  std::printf("%d outside, %d crossing, %d inside\n", outside, crossing, inside);
  EXPECT_GT(outside, 100);
  EXPECT_GT(crossing, 100);
  EXPECT_GT(inside, 20);
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/capsule_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double radius = 0.0025;
constexpr double top = 0.01;
constexpr double half = 0.05;

/// A slab of 100 x 100 x 20 mm, squares of 10 mm.
struct Slab {
  SurfaceDescription skin = test::boxSurface(Vec3(-half, -half, -top), Vec3(half, half, top), {10, 10, 2});
  ContactSurface surface{skin.vertex, skin.triangle};
  std::vector<std::uint32_t> patches;

  Slab() {
    patches.resize(surface.patches().size());
    std::iota(patches.begin(), patches.end(), 0U);
  }
  [[nodiscard]] std::vector<SurfaceContact> contacts(const Vec3& p0, const Vec3& p1, double reach) const {
    std::vector<SurfaceContact> out;
    capsuleContacts(surface, skin.vertex, patches, p0, p1, radius, reach, 3, out);
    return out;
  }
  [[nodiscard]] Vec3 pointOf(const SurfaceContact& c) const {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      p += c.weight[static_cast<int>(k)] * skin.vertex[static_cast<std::size_t>(c.node[k])];
    return p;
  }
};

TEST(CapsuleContact, AFlatRegionGivesExactlyOneRow) {
  const Slab slab;
  SCOPED_TRACE("seed 61");
  Random random(61);
  for (int trial = 0; trial < 400; ++trial) {
    // Inside faces, on their edges and on their corners alike; from straight down to nearly flat.
    Vec3 foot(random.uniform(-0.035, 0.035), random.uniform(-0.035, 0.035), top);
    if (trial % 4 == 1) foot[0] = 0.01;
    if (trial % 4 == 2) foot[0] = foot[1] = -0.02;
    if (trial % 4 == 3) foot[0] = foot[1];  // on the diagonals
    const double height = random.uniform(1e-4, 0.006);
    const Vec3 p0 = foot + height * Vec3::UnitZ();
    const Vec3 lean(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.2, 1.0));
    const std::vector<SurfaceContact> found = slab.contacts(p0, p0 + 0.02 * lean.normalized(), 0.005);
    ASSERT_EQ(found.size(), 1U) << "trial " << trial << ": one place is one row, on an edge or a corner too";
    for (const SurfaceContact& c : found) {
      EXPECT_NEAR(c.gap, height - radius, 1e-12);
      EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-9);
      EXPECT_LT((c.onAxis - p0).norm(), 1e-12);
      EXPECT_LT((slab.pointOf(c) - foot).norm(), 1e-9);
      EXPECT_NEAR(c.weight.sum(), 1.0, 1e-12);
      EXPECT_GE(c.weight.minCoeff(), 0.0);
      EXPECT_EQ(c.key >> 56U, 3U) << "the piece is part of the key";
    }
  }
}

TEST(CapsuleContact, BeyondReachThereIsNone) {
  const Slab slab;
  const Vec3 p0(0.003, 0.004, top + radius + 0.002);
  EXPECT_EQ(slab.contacts(p0, p0 + 0.02 * Vec3::UnitZ(), 0.00199).size(), 0U);
  EXPECT_EQ(slab.contacts(p0, p0 + 0.02 * Vec3::UnitZ(), 0.00201).size(), 1U);
}

TEST(CapsuleContact, AConvexEdgeGivesOneRowAcrossIt) {
  const Slab slab;
  const Vec3 out = Vec3(1.0, 0.0, 1.0).normalized();
  const Vec3 along = Vec3(1.0, 0.0, -1.0).normalized();
  for (const double distance : {0.001, 0.0025, 0.004}) {
    for (const double y : {0.003, 0.0125, -0.0444}) {
      const Vec3 centre = Vec3(half, y, top) + distance * out;
      const std::vector<SurfaceContact> found = slab.contacts(centre - 0.01 * along, centre + 0.01 * along, 0.003);
      ASSERT_EQ(found.size(), 1U) << distance << " " << y;
      EXPECT_NEAR(found[0].gap, distance - radius, 1e-12);
      EXPECT_LT((found[0].normal - out).norm(), 1e-9);
      EXPECT_LT((slab.pointOf(found[0]) - Vec3(half, y, top)).norm(), 1e-9);
    }
  }
}

TEST(CapsuleContact, ACornerGivesOneRowAwayFromIt) {
  const Slab slab;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      for (const double sz : {-1.0, 1.0}) {
        const Vec3 out = Vec3(sx, sy, sz).normalized();
        const Vec3 corner(sx * half, sy * half, sz * top);
        const std::vector<SurfaceContact> found = slab.contacts(corner + 0.003 * out, corner + 0.02 * out, 0.003);
        ASSERT_EQ(found.size(), 1U);
        EXPECT_NEAR(found[0].gap, 0.003 - radius, 1e-12);
        EXPECT_LT((found[0].normal - out).norm(), 1e-9);
      }
    }
  }
}

TEST(CapsuleContact, PenetrationPointsOutOfTheFace) {
  const Slab slab;
  const Vec3 foot(0.0031, 0.0017, top);
  // The axis still outside, the shaft already in.
  std::vector<SurfaceContact> found = slab.contacts(foot + 0.001 * Vec3::UnitZ(), foot + 0.03 * Vec3::UnitZ(), 0.003);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].gap, 0.001 - radius, 1e-12);
  // The end of the axis 1 mm below the face: the axis passes through it.
  found = slab.contacts(foot - 0.001 * Vec3::UnitZ(), foot + 0.03 * Vec3::UnitZ(), 0.003);
  ASSERT_GE(found.size(), 1U);
  for (const SurfaceContact& c : found) {
    EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_LE(c.gap, 0.0);
  }
  EXPECT_NEAR(
      std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; })->gap,
      -0.001 - radius, 1e-12);
  // The whole axis 2 mm below the face and parallel to it: still on this side of the slab.
  found = slab.contacts(Vec3(0.0031, 0.0017, top - 0.002), Vec3(0.0231, 0.0057, top - 0.002), 0.003);
  ASSERT_GE(found.size(), 1U);
  for (const SurfaceContact& c : found) {
    EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_NEAR(c.gap, -0.002 - radius, 1e-12);
  }
}

/// A shaft that passes beside the slab, within reach of its side: one row, sideways; nothing that would stop it from
/// going on along itself.
TEST(CapsuleContact, PassingByIsNotStopped) {
  const Slab slab;
  const double x = half + radius + 0.0005;
  const std::vector<SurfaceContact> found = slab.contacts(Vec3(x, 0.0031, -0.03), Vec3(x, 0.0031, 0.03), 0.001);
  ASSERT_GE(found.size(), 1U);
  for (const SurfaceContact& c : found) {
    EXPECT_LT((c.normal - Vec3::UnitX()).norm(), 1e-9);
    EXPECT_NEAR(c.gap, 0.0005, 1e-12);
  }
  EXPECT_TRUE(slab.contacts(Vec3(x + 0.001, 0.0031, -0.03), Vec3(x + 0.001, 0.0031, 0.03), 0.001).empty());
}

TEST(CapsuleContact, AppendsInOrderOfKeysEachOnce) {
  const Slab slab;
  SurfaceContact before;
  before.key = ~std::uint64_t{0};
  std::vector<SurfaceContact> out{before};
  capsuleContacts(slab.surface, slab.skin.vertex, slab.patches, Vec3(-0.04, 0.0031, top + 0.002),
                  Vec3(0.04, 0.0057, top + 0.002), radius, 0.003, 0, out);
  ASSERT_GT(out.size(), 3U) << "a shaft that lies on a plane is carried along its length";
  EXPECT_EQ(out.front().key, before.key) << "what was there stays";
  for (std::size_t i = 2; i < out.size(); ++i) EXPECT_LT(out[i - 1].key, out[i].key);
  double least = 1.0;
  for (std::size_t i = 1; i < out.size(); ++i) least = std::min(least, out[i].gap);
  EXPECT_EQ(minGap(slab.surface, slab.skin.vertex, slab.patches, Vec3(-0.04, 0.0031, top + 0.002),
                   Vec3(0.04, 0.0057, top + 0.002), radius, 0.003),
            least);
  EXPECT_EQ(
      minGap(slab.surface, slab.skin.vertex, slab.patches, Vec3(0.0, 0.0, 0.05), Vec3(0.0, 0.0, 0.06), radius, 0.003),
      0.003)
      << "nothing near: the reach";
}

TEST(ContactSurface, PatchesPartitionTheTrianglesAndBoundThem) {
  const Slab slab;
  EXPECT_EQ(slab.surface.triangles().size(), slab.skin.triangle.size());
  std::vector<Box> bounds;
  patchBounds(slab.surface, slab.skin.vertex, 0.001, bounds);
  ASSERT_EQ(bounds.size(), slab.surface.patches().size());
  std::size_t next = 0;
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    const ContactSurface::Patch& patch = slab.surface.patches()[p];
    EXPECT_EQ(patch.first, next) << "no gap, no overlap";
    EXPECT_LE(patch.last - patch.first, ContactSurface::maxPatchTriangles);
    next = patch.last;
    for (std::size_t t = patch.first; t < patch.last; ++t) {
      for (int k = 0; k < 3; ++k) {
        const Vec3& v = slab.skin.vertex[static_cast<std::size_t>(slab.surface.triangles()[t][k])];
        EXPECT_TRUE(((v - bounds[p].lower).array() >= 0.001).all() && ((bounds[p].upper - v).array() >= 0.001).all());
        // The node opposite to each edge belongs to another triangle, over the same edge turned round.
        const int third = slab.surface.opposite(t, k);
        ASSERT_GE(third, 0) << "a closed surface has a neighbour across every edge";
        EXPECT_NE(third, slab.surface.triangles()[t][(k + 2) % 3]);
      }
    }
  }
  EXPECT_EQ(next, slab.skin.triangle.size());
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/closest_point_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "sim/geometry/surface_distance.h"
#include "sim/math/elementary.h"
#include "sim/math/random.h"
#include "tests/sim/geometry/surfaces.h"
#include "tests/support/message.h"

namespace calot {
namespace {

/// A sphere with radii drawn at random: convex and concave edges, saddles, needles.
TriangleMesh roughSphere(Random& random, int rounds, double roughness) {
  TriangleMesh mesh = test::refinedSphere(Vec3::Zero(), 1.0, rounds);
  for (Vec3& p : mesh.vertex) p *= random.uniform(1.0 - roughness, 1.0);
  return mesh;
}

struct Compared {
  int band = 0;
  int missed = 0;
  int wrongSign = 0;
  double error = 0.0;  // cells
};

/// Against every triangle, without any structure; signs against a winding number.
Compared compare(const TriangleMesh& mesh, const BrickLattice& lattice, const DistanceTransform& field) {
  Compared c;
  const SurfaceDistance winding(mesh, InsideRule::winding);
  Index3 n;
  for (n[2] = 0; n[2] < lattice.nodes()[2]; ++n[2]) {
    for (n[1] = 0; n[1] < lattice.nodes()[1]; ++n[1]) {
      for (n[0] = 0; n[0] < lattice.nodes()[0]; ++n[0]) {
        const Vec3 p = lattice.position(n);
        double least = 1e300;
        for (int t = 0; t < mesh.triangles(); ++t) {
          least = std::min(
              least, closestOnTriangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).squaredDistance);
        }
        const double truth = std::sqrt(least);
        const double got = field.value[lattice.node(n)];
        const bool inside = winding.windingNumber(p) > 0.5;
        if (truth > 1e-9 * lattice.cell() && (got < 0.0) != inside) ++c.wrongSign;
        if (truth >= field.band) {
          EXPECT_EQ(std::abs(got), field.band);
          continue;
        }
        ++c.band;
        const double error = std::abs(std::abs(got) - truth) / lattice.cell();
        if (error > 0.01) ++c.missed;
        c.error = std::max(c.error, error);
      }
    }
  }
  return c;
}

TEST(ClosestPointTransform, FindsEveryNodeOfTheBandOnRandomSurfaces) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed, 77);
    const double roughness = random.uniform(0.0, 0.7);
    const double band = random.uniform(1.5, 5.0);
    const TriangleMesh mesh = roughSphere(random, 1 + static_cast<int>(seed % 3), roughness);
    const BrickLattice lattice = BrickLattice::around(bounds(mesh), random.uniform(0.07, 0.12), 2);
    const DistanceTransform field = closestPointTransform(mesh, lattice, band);
    ASSERT_EQ(field.error, "");
    const Compared c = compare(mesh, lattice, field);
    std::cout << "seed " << seed << ": " << mesh.triangles() << " triangles, roughness " << roughness << ", band "
              << band << ": " << c.band << " nodes, missed " << c.missed << ", wrong sign " << c.wrongSign << ", error "
              << c.error << " cells, rule " << (field.rule == SignRule::regions ? "regions" : "normals") << "\n";
    EXPECT_GT(c.band, 500);
    EXPECT_EQ(c.missed, 0);
    EXPECT_EQ(c.wrongSign, 0);
    EXPECT_LT(c.error, 1e-12);
    EXPECT_EQ(field.rule, SignRule::pseudonormals);
  }
}

TEST(ClosestPointTransform, HoldsOnNodesOfTheLatticeAndFlatSides) {
  // Corners, edges and faces right on lattice nodes: every decision is a tie.
  const TriangleMesh mesh = test::boxSurface({-0.5, -0.25, -0.5}, {0.5, 0.25, 0.75});
  const BrickLattice lattice({-1.0, -1.0, -1.0}, 0.125, {17, 17, 19});
  const DistanceTransform field = closestPointTransform(mesh, lattice, 3.0);
  ASSERT_EQ(field.error, "");
  const Compared c = compare(mesh, lattice, field);
  EXPECT_EQ(c.missed, 0);
  EXPECT_EQ(c.wrongSign, 0);
  EXPECT_LT(c.error, 1e-12);
}

TEST(ClosestPointTransform, TakesTheUnionOfOverlappingParts) {
  const TriangleMesh mesh = test::together(test::boxSurface({-0.61, -0.6, -0.6}, {0.2, 0.63, 0.6}),
                                           test::turned(test::turned(test::refinedSphere({0.4, 0.1, 0.0}, 0.7, 3))));
  const BrickLattice lattice = BrickLattice::around(bounds(mesh), 0.1, 3);
  const DistanceTransform field = closestPointTransform(mesh, lattice, 3.0);
  ASSERT_EQ(field.error, "");
  EXPECT_EQ(field.rule, SignRule::regions);
  const Compared c = compare(mesh, lattice, field);
  EXPECT_EQ(c.missed, 0);
  EXPECT_EQ(c.wrongSign, 0);
}

TEST(ClosestPointTransform, KeepsACavity) {
  const TriangleMesh mesh = test::together(test::boxSurface({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}),
                                           test::turned(test::refinedSphere(Vec3::Zero(), 0.6, 2)));
  const BrickLattice lattice = BrickLattice::around(bounds(mesh), 0.093, 3);
  const DistanceTransform field = closestPointTransform(mesh, lattice, 3.0);
  ASSERT_EQ(field.error, "");
  EXPECT_EQ(field.rule, SignRule::pseudonormals);
  EXPECT_EQ(compare(mesh, lattice, field).wrongSign, 0);
}

TEST(ClosestPointTransform, RefusesWithAReason) {
  const TriangleMesh mesh = test::refinedSphere(Vec3::Zero(), 1.0, 2);
  const BrickLattice lattice = BrickLattice::around(bounds(mesh), 0.1, 3);
  TriangleMesh open = mesh;
  open.triangle.pop_back();
  TriangleMesh far = mesh, nan = mesh;
  far.vertex[5] *= 3.0;
  nan.vertex[5][1] = std::nan("");
  const auto error = [&](const TriangleMesh& of, double band = 3.0) {
    return closestPointTransform(of, lattice, band).error;
  };
  expectNames(error(open), {"3"});
  expectNames(error(mesh, 0.5), {"band"});
  expectNames(error(far), {"border"});
  expectDistinct({error(open), error(test::turned(mesh)), error(mesh, 0.5), error({}), error(far), error(nan)});
}

}  // namespace
}  // namespace calot

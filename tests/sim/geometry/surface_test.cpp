// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "sim/geometry/surface_distance.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/random.h"
#include "tests/sim/geometry/surfaces.h"

namespace calot {
namespace {

using test::boxSurface;
using test::refinedSphere;
using test::together;
using test::turned;

const Vec3 one = Vec3::Ones();

TEST(TriangleMesh, MeasuresOfABox) {
  const TriangleMesh box = boxSurface({1.0, 2.0, 3.0}, {3.0, 5.0, 7.0});
  EXPECT_NEAR(signedVolume(box), 24.0, 1e-12);
  EXPECT_NEAR(signedVolume(turned(box)), -24.0, 1e-12);
  EXPECT_NEAR(surfaceArea(box), 52.0, 1e-12);
  EXPECT_EQ(bounds(box).lower, Vec3(1.0, 2.0, 3.0));
  for (const Index3& n : triangleNeighbours(box)) EXPECT_GE(n.minCoeff(), 0);
}

TEST(SurfaceReport, ASoundSurface) {
  const SurfaceReport report = inspectSurface(boxSurface(-one, one));
  EXPECT_TRUE(report.closedManifold());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.degenerateTriangles + report.duplicateTriangles + report.coincidentVertices + report.unusedVertices,
            0);
}

TEST(SurfaceReport, NamesEveryFault) {
  TriangleMesh hole = boxSurface(-one, one);
  hole.triangle.erase(hole.triangle.begin());
  SurfaceReport report = inspectSurface(hole);
  EXPECT_EQ(report.openEdges, 3);
  EXPECT_EQ(report.holes, 1);
  EXPECT_FALSE(report.closedManifold());

  TriangleMesh flipped = boxSurface(-one, one);
  std::swap(flipped.triangle[4][0], flipped.triangle[4][1]);
  report = inspectSurface(flipped);
  EXPECT_EQ(report.flippedEdges, 3);
  EXPECT_FALSE(report.closedManifold());

  TriangleMesh doubled = boxSurface(-one, one);
  doubled.triangle.push_back(Index3(doubled.triangle[2][1], doubled.triangle[2][2], doubled.triangle[2][0]));
  doubled.triangle.emplace_back(0, 0, 1);
  doubled.vertex.push_back(doubled.vertex[3]);
  report = inspectSurface(doubled);
  EXPECT_EQ(report.duplicateTriangles, 1);
  EXPECT_EQ(report.degenerateTriangles, 1);
  EXPECT_EQ(report.coincidentVertices, 1);
  EXPECT_EQ(report.unusedVertices, 1);
  EXPECT_GE(report.nonManifoldEdges, 3);

  report = inspectSurface(turned(boxSurface(-one, one)));
  EXPECT_EQ(report.inwardComponents, 1);
  EXPECT_FALSE(report.closedManifold());
}

TEST(SurfaceReport, ACavityIsNoFaultAndAnOutwardShellInsideIs) {
  const TriangleMesh outer = boxSurface(-one, one);
  const TriangleMesh inner = boxSurface(-0.5 * one, 0.5 * one);
  SurfaceReport report = inspectSurface(together(outer, turned(inner)));
  EXPECT_EQ(report.cavities, 1);
  EXPECT_TRUE(report.closedManifold());
  EXPECT_NEAR(report.volume, 7.0, 1e-12);
  EXPECT_NEAR(signedVolume(repairSurface(together(outer, inner)).mesh), 7.0, 1e-12);
}

TEST(RepairSurface, MakesTriangleSoupWhole) {
  // Every triangle with corners of its own, a third of them turned, duplicates among them.
  const TriangleMesh box = refinedSphere(one, 2.0, 2);
  Random random(5);
  TriangleMesh soup;
  for (int t = 0; t < box.triangles(); ++t) {
    const int base = soup.vertices();
    for (int k = 0; k < 3; ++k) soup.vertex.push_back(box.corner(t, k));
    if (random.uniform() < 0.33) {
      soup.triangle.emplace_back(base, base + 2, base + 1);
    } else {
      soup.triangle.emplace_back(base, base + 1, base + 2);
    }
    if (t % 40 == 0) soup.triangle.push_back(soup.triangle.back());
  }
  soup.vertex.emplace_back(9.0, 9.0, 9.0);
  const SurfaceRepair repair = repairSurface(soup);
  EXPECT_TRUE(inspectSurface(repair.mesh).closedManifold());
  EXPECT_EQ(repair.mesh.vertices(), box.vertices());
  EXPECT_EQ(repair.mesh.triangles(), box.triangles());
  EXPECT_EQ(repair.droppedDuplicates, (box.triangles() + 39) / 40);
  EXPECT_EQ(repair.weldedVertices, soup.vertices() - 1 - box.vertices());
  EXPECT_EQ(repair.droppedVertices, 1);
  EXPECT_GT(repair.flippedTriangles, 0);
  EXPECT_NEAR(signedVolume(repair.mesh), signedVolume(box), 1e-12);
  EXPECT_FALSE(repairSurface(box).changed());
}

TEST(RepairSurface, InventsNothing) {
  TriangleMesh hole = boxSurface(-one, one);
  hole.triangle.pop_back();
  EXPECT_EQ(inspectSurface(repairSurface(hole).mesh).openEdges, 3);
}

TEST(SurfaceDistance, ClosestAgreesWithTestingEveryTriangle) {
  const TriangleMesh sphere = refinedSphere({0.1, -0.2, 0.3}, 0.8, 3);
  const SurfaceDistance distance(sphere);
  Random random(11);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
    double best = 1e300;
    int which = -1;
    for (int t = 0; t < sphere.triangles(); ++t) {
      const double d =
          closestOnTriangle(p, sphere.corner(t, 0), sphere.corner(t, 1), sphere.corner(t, 2)).squaredDistance;
      if (d < best) {
        best = d;
        which = t;
      }
    }
    EXPECT_EQ(distance.closest(p).triangle, which);
    EXPECT_EQ(distance.closest(p).on.squaredDistance, best);
    EXPECT_EQ(distance.closest(p, trial % sphere.triangles()).triangle, which);
  }
}

/// Exact signed distance to a box.
double boxDistance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(Vec3::Zero()).norm() + std::min(q.maxCoeff(), 0.0);
}

TEST(SurfaceDistance, SignedDistanceOfABoxIsExactWithBothRules) {
  const Vec3 half(1.0, 0.6, 0.3);
  const TriangleMesh box = boxSurface(-half, half);
  const SurfaceDistance normals(box, InsideRule::pseudonormal);
  const SurfaceDistance winding(box, InsideRule::winding);
  EXPECT_EQ(SurfaceDistance(box).rule(), InsideRule::pseudonormal);
  Random random(3);
  for (int trial = 0; trial < 5000; ++trial) {
    const Vec3 p(random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8));
    const double exact = boxDistance(p, half);
    EXPECT_NEAR(normals.signedDistance(p), exact, 1e-14);
    EXPECT_NEAR(winding.signedDistance(p), exact, 1e-14);
  }
}

TEST(SurfaceDistance, WindingHoldsWhereNormalsLie) {
  // Two boxes through one another: the parts inside the other have normals that point into the solid.
  const TriangleMesh crossed =
      together(boxSurface({-1.0, -0.3, -0.3}, {1.0, 0.3, 0.3}), boxSurface({-0.3, -1.0, -0.31}, {0.3, 1.0, 0.29}));
  const SurfaceDistance winding(crossed, InsideRule::winding);
  EXPECT_LT(winding.signedDistance({0.0, 0.0, 0.0}), 0.0);
  EXPECT_LT(winding.signedDistance({0.299, 0.0, 0.0}), 0.0);
  EXPECT_LT(winding.signedDistance({0.301, 0.0, 0.0}), 0.0);
  EXPECT_GT(winding.signedDistance({0.5, 0.5, 0.0}), 0.0);
  EXPECT_NEAR(winding.windingNumber({0.0, 0.0, 0.0}), 2.0, 0.05);

  TriangleMesh open = refinedSphere(Vec3::Zero(), 1.0, 3);
  open.triangle.erase(open.triangle.begin() + 17);
  EXPECT_EQ(SurfaceDistance(open).rule(), InsideRule::winding);
  EXPECT_LT(SurfaceDistance(open).signedDistance({0.1, 0.2, 0.3}), 0.0);
  EXPECT_GT(SurfaceDistance(open).signedDistance({1.1, 0.2, 0.3}), 0.0);
}

TEST(SurfaceDistance, WindingNumberOfClustersStaysNearTheExactOne) {
  const SurfaceDistance sphere(refinedSphere(Vec3::Zero(), 1.0, 4), InsideRule::winding);
  Random random(21);
  double worst = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
    if (std::abs(p.norm() - 1.0) < 0.02) continue;
    worst = std::max(worst, std::abs(sphere.windingNumber(p) - (p.norm() < 1.0 ? 1.0 : 0.0)));
  }
  EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/surface_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "recorder/formats/mesh_file.h"
#include "tests/sim/geometry/surfaces.h"

namespace calot {
namespace {

/// Takes out the triangles whose centroid is nearer than `radius` to `centre`.
TriangleMesh without(TriangleMesh mesh, const Vec3& centre, double radius) {
  TriangleMesh left = mesh;
  left.triangle.clear();
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Vec3 centroid = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    if ((centroid - centre).norm() >= radius) left.triangle.push_back(mesh.triangle[slot(t)]);
  }
  return repairSurface(left).mesh;
}

void expectClosed(const HoleFilling& filling, double volume, double share) {
  const SurfaceReport now = inspectSurface(filling.mesh);
  EXPECT_TRUE(now.closedManifold()) << now.openEdges << " open, " << now.nonManifoldEdges << " not manifold, "
                                    << now.flippedEdges << " flipped";
  EXPECT_EQ(now.degenerateTriangles, 0);
  EXPECT_NEAR(now.volume, volume, share * volume);
  EXPECT_EQ(findSelfCrossing(filling.mesh).pairs, 0U);
}

TEST(HoleFilling, AClosedSurfaceHasNoHoles) {
  const TriangleMesh sphere = test::refinedSphere(Vec3::Zero(), 0.05, 3);
  EXPECT_TRUE(findHoles(sphere).empty());
  EXPECT_EQ(fillHoles(sphere).mesh.triangle.size(), sphere.triangle.size());
}

TEST(HoleFilling, ABoxWithoutASideIsTheSameBoxAgain) {
  TriangleMesh box = test::boxSurface({0.0, 0.0, 0.0}, {0.1, 0.2, 0.3});
  box.triangle.erase(box.triangle.begin(), box.triangle.begin() + 2);  // z = 0
  const HoleFilling filling = fillHoles(box);
  ASSERT_EQ(filling.holes.size(), 1U);
  EXPECT_EQ(filling.holes[0].vertex.size(), 4U);
  EXPECT_NEAR((filling.holes[0].centre - Vec3(0.05, 0.1, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(filling.holes[0].perimeter, 0.6, 1e-15);
  EXPECT_NEAR(filling.holes[0].area, 0.02, 1e-15);
  expectClosed(filling, 0.006, 1e-12);
}

TEST(HoleFilling, HolesOfASphereAreFoundAndFilled) {
  const double radius = 0.05;
  const TriangleMesh whole = test::refinedSphere(Vec3::Zero(), radius, 4);
  TriangleMesh sphere = without(whole, radius * Vec3::UnitX(), 0.012);
  sphere = without(sphere, -radius * Vec3::UnitZ(), 0.02);
  const std::vector<SurfaceHole> holes = findHoles(sphere);
  ASSERT_EQ(holes.size(), 2U);
  for (const SurfaceHole& hole : holes) {
    EXPECT_GT(hole.vertex.size(), 8U);
    const Vec3 nearest = hole.centre[0] > 0.02 ? Vec3(radius * Vec3::UnitX()) : Vec3(-radius * Vec3::UnitZ());
    EXPECT_LT((hole.centre - nearest).norm(), 0.006);
  }
  // Flat fillings cut off two caps: (pi h^2 / 3) (3 r - h), 0.7 % of the volume.
  const HoleFilling filling = fillHoles(sphere);
  expectClosed(filling, signedVolume(whole), 0.01);
  EXPECT_LT(signedVolume(filling.mesh), signedVolume(whole));
}

TEST(HoleFilling, TrianglesThatTouchInAPointAreTwoHoles) {
  TriangleMesh sphere = test::refinedSphere(Vec3::Zero(), 0.05, 2);
  const int pivot = sphere.triangle[0][0];
  std::vector<std::size_t> around;
  for (std::size_t t = 0; t < sphere.triangle.size(); ++t) {
    if ((sphere.triangle[t].array() == pivot).any()) around.push_back(t);
  }
  ASSERT_GE(around.size(), 4U);
  // The first, and one that shares the corner alone with it.
  const auto shared = [&](std::size_t x, std::size_t y) {
    int count = 0;
    for (int k = 0; k < 3; ++k) count += (sphere.triangle[x].array() == sphere.triangle[y][k]).any() ? 1 : 0;
    return count;
  };
  const auto other =
      std::find_if(around.begin() + 1, around.end(), [&](std::size_t t) { return shared(around[0], t) == 1; });
  ASSERT_NE(other, around.end());
  const double volume = signedVolume(sphere);
  sphere.triangle.erase(sphere.triangle.begin() + static_cast<std::ptrdiff_t>(*other));
  sphere.triangle.erase(sphere.triangle.begin() + static_cast<std::ptrdiff_t>(around[0]));
  const HoleFilling filling = fillHoles(sphere);
  EXPECT_EQ(filling.holes.size(), 2U);
  expectClosed(filling, volume, 1e-12);
}

TEST(HoleFilling, ALongHoleIsLeftAndSaid) {
  TriangleMesh fan;  // a flat disk, its rim the hole
  const int edges = maxHoleEdges + 1;
  fan.vertex.emplace_back(Vec3::Zero());
  for (int i = 0; i < edges; ++i) {
    const double angle = 2.0 * 3.14159265358979323846 * i / edges;
    fan.vertex.emplace_back(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.0);
    fan.triangle.emplace_back(0, 1 + i, 1 + (i + 1) % edges);
  }
  const HoleFilling filling = fillHoles(fan);
  ASSERT_EQ(filling.holes.size(), 1U);
  EXPECT_FALSE(filling.holes[0].fault.empty());
  EXPECT_EQ(filling.mesh.triangle.size(), fan.triangle.size());
}

TEST(HoleFilling, OrgansWithTrianglesTakenOutHaveTheirVolumeAgain) {
  for (const char* organ : {"liver", "gallbladder"}) {
    SCOPED_TRACE(organ);
    const auto file = std::filesystem::path(CALOT_SOURCE_DIR) / "assets" / "organs" / (std::string(organ) + ".obj");
    const TriangleMesh whole = recorder::readSurface(file, recorder::LengthUnit::metre);
    TriangleMesh torn = whole;
    // Three patches, the largest some centimetres across.
    const double size = (bounds(whole).upper - bounds(whole).lower).maxCoeff();
    for (const auto& [share, radius] : {std::pair{0.1, 0.03}, std::pair{0.5, 0.06}, std::pair{0.9, 0.1}}) {
      const Vec3 at = whole.vertex[static_cast<std::size_t>(share * static_cast<double>(whole.vertex.size()))];
      torn = without(torn, at, radius * size);
    }
    ASSERT_GE(findHoles(torn).size(), 1U);
    const HoleFilling filling = fillHoles(torn);
    const SurfaceReport now = inspectSurface(filling.mesh);
    EXPECT_TRUE(now.closedManifold());
    EXPECT_NEAR(now.volume, signedVolume(whole), 0.02 * signedVolume(whole));
  }
}

}  // namespace
}  // namespace calot

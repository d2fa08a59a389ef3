// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "sim/geometry/surface_report.h"
#include "sim/math/random.h"

namespace calot {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

double volumeOf(const TetrahedralMesh& mesh, const Index4& v) {
  const Vec3& a = mesh.vertex[slot(v[0])];
  return (mesh.vertex[slot(v[1])] - a).cross(mesh.vertex[slot(v[2])] - a).dot(mesh.vertex[slot(v[3])] - a) / 6.0;
}

std::vector<double> sampled(const BccLattice& lattice, double (*f)(const Vec3&)) {
  std::vector<double> value;
  for (std::int64_t p = 0; p < lattice.points(); ++p) value.push_back(f(lattice.position(p)));
  return value;
}

TEST(BccLattice, TilesItsCoreWithoutGapOrOverlap) {
  // Everything inside but the outermost layer: the tetrahedra then fill a body without a cut.
  BccLattice lattice;
  lattice.cell = 0.5;
  lattice.size = Index3(4, 5, 6);
  const std::vector<double> value(static_cast<std::size_t>(lattice.points()), -1.0);
  const TetrahedralMesh mesh = stuff(lattice, value, 0.0);
  for (const Index4& v : mesh.tetrahedron) EXPECT_NEAR(volumeOf(mesh, v), 0.125 / 12.0, 1e-15);
  const DihedralRange range = dihedralRange(mesh);
  EXPECT_NEAR(range.min / degree, 60.0, 1e-9);
  EXPECT_NEAR(range.max / degree, 90.0, 1e-9);
  // No face in three tetrahedra, and the boundary is closed: nothing overlaps, nothing is missing.
  const SurfaceReport report = inspectSurface(boundarySurface(mesh));
  EXPECT_TRUE(report.closedManifold());
  EXPECT_NEAR(report.volume, meshVolume(mesh), 1e-12);
}

TEST(Stuffing, SphereConvergesInVolume) {
  const auto sphere = [](const Vec3& p) { return p.norm() - 1.0; };
  double last = 1.0;
  for (const double cell : {0.5, 0.25, 0.125}) {
    const BccLattice lattice = BccLattice::around({-Vec3::Ones(), Vec3::Ones()}, cell);
    const TetrahedralMesh mesh = stuff(lattice, sampled(lattice, sphere), 0.0);
    const double error = 1.0 - meshVolume(mesh) / (4.0 / 3.0 * 3.14159265358979);
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 0.45 * last);  // second order, less what snapping disturbs
    last = error;
    const TriangleMesh surface = boundarySurface(mesh);
    EXPECT_TRUE(inspectSurface(surface).closedManifold());
    EXPECT_NEAR(signedVolume(surface), meshVolume(mesh), 1e-12);
    for (const Vec3& p : surface.vertex) EXPECT_NEAR(p.norm(), 1.0, 0.3 * cell * cell);
  }
}

TEST(Stuffing, ALevelIsAGrownShape) {
  const auto sphere = [](const Vec3& p) { return p.norm() - 1.0; };
  const BccLattice lattice = BccLattice::around({-1.2 * Vec3::Ones(), 1.2 * Vec3::Ones()}, 0.2);
  const std::vector<double> value = sampled(lattice, sphere);
  EXPECT_LT(meshVolume(stuff(lattice, value, -0.1)), meshVolume(stuff(lattice, value, 0.0)));
  EXPECT_NEAR(meshVolume(stuff(lattice, value, 0.1)) / meshVolume(stuff(lattice, value, 0.0)), 1.331, 0.02);
}

/// Sides at random, and a cut of its own on every edge, often just beside a limit at which points are moved: what a
/// smooth shape never shows.
struct Adversary {
  Adversary(const BccLattice& lattice, Random& random)
      : corners(lattice.corners()), seed(random.next()), style(random.next() % 4) {
    const double inside = random.uniform(0.2, 0.8);
    for (std::int64_t p = 0; p < lattice.points(); ++p) value.push_back(random.uniform() < inside ? -1.0 : 1.0);
  }

  [[nodiscard]] CutShare cuts() const {
    return [this](std::int64_t p, std::int64_t q) {
      Random edge(seed + static_cast<std::uint64_t>(p), static_cast<std::uint64_t>(q));
      if (style == 0) return edge.uniform(0.001, 0.999);
      const bool isLong = (p < corners) == (q < corners);
      const double limit = isLong ? StuffingLimits().longEdge : StuffingLimits().shortEdge;
      const std::uint32_t choice = edge.next() % (style == 1 ? 4 : 8);
      if (choice == 0) return limit + 1e-7;
      if (choice == 1) return 1.0 - limit - 1e-7;
      if (choice == 2) return limit - 1e-7;
      if (choice == 3) return 1.0 - limit + 1e-7;
      if (style == 2) return choice % 2 == 0 ? limit + 1e-7 : 1.0 - limit - 1e-7;
      return edge.uniform(limit, 1.0 - limit);
    };
  }

  std::int64_t corners;
  std::uint64_t seed;
  std::uint32_t style;
  std::vector<double> value;
};

TEST(Stuffing, DihedralAnglesHoldForAnyCuts) {
  const std::uint64_t seed = 424242;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random(seed);
  double smallest = 180.0;
  double largest = 0.0;
  std::size_t tetrahedra = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    BccLattice lattice;
    lattice.cell = 1.0;
    lattice.size = Index3(4, 4, 4);
    lattice.origin = Vec3(0.1, 0.2, 0.3);
    const Adversary adversary(lattice, random);
    const TetrahedralMesh mesh = stuff(lattice, adversary.value, 0.0, {}, adversary.cuts());
    if (mesh.tetrahedron.empty()) continue;
    for (const Index4& v : mesh.tetrahedron) ASSERT_GT(volumeOf(mesh, v), 1e-4);
    const DihedralRange range = dihedralRange(mesh);
    smallest = std::min(smallest, range.min / degree);
    largest = std::max(largest, range.max / degree);
    tetrahedra += mesh.tetrahedron.size();
  }
  std::cout << tetrahedra << " tetrahedra, dihedral angles in [" << smallest << ", " << largest << "] degrees\n";
  EXPECT_GE(smallest, 10.65);
  EXPECT_LE(largest, 164.71);
  // The adversary is one: ordinary shapes stay in [14, 152].
  EXPECT_LT(smallest, 10.7);
  EXPECT_GT(largest, 164.6);
}

TEST(Stuffing, NeighboursAgreeOnEveryFaceWhateverTheCuts) {
  Random random(77);
  for (int trial = 0; trial < 300; ++trial) {
    BccLattice lattice;
    lattice.cell = 1.0;
    lattice.size = Index3(5, 5, 5);
    Adversary adversary(lattice, random);
    std::vector<double>& value = adversary.value;
    for (std::int64_t p = 0; p < lattice.points(); ++p) {
      const Vec3 x = lattice.position(p);
      if (x.minCoeff() <= 0.5 || x.maxCoeff() >= 3.5) value[static_cast<std::size_t>(p)] = 1.0;
    }
    const TetrahedralMesh mesh = stuff(lattice, value, 0.0, {}, adversary.cuts());
    // A face that two neighbours cut differently would leave an inner face open: then the boundary's volume, or its
    // balance of areas, is off.
    const TriangleMesh surface = boundarySurface(mesh);
    const SurfaceReport report = inspectSurface(surface);
    EXPECT_EQ(report.openEdges, 0);
    EXPECT_EQ(report.flippedEdges, 0);
    EXPECT_NEAR(report.volume, meshVolume(mesh), 1e-12);
    // Every boundary vertex is on the surface: on an edge's cut or a moved point, never a point that stayed.
    for (const BoundaryTriangle& t : boundaryTriangles(mesh)) {
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = mesh.vertex[slot(t.vertex[k])];
        for (std::int64_t q = 0; q < lattice.points(); ++q) {
          EXPECT_NE(p, lattice.position(q));
        }
      }
    }
  }
}

TEST(Stuffing, ValuesExactlyOnTheSurface) {
  // A box whose faces pass through lattice points: zeros everywhere.
  const auto box = [](const Vec3& p) { return p.cwiseAbs().maxCoeff() - 0.5; };
  BccLattice lattice;
  lattice.cell = 0.25;
  lattice.size = Index3(9, 9, 9);
  lattice.origin = Vec3::Constant(-1.0);
  const TetrahedralMesh mesh = stuff(lattice, sampled(lattice, box), 0.0);
  EXPECT_NEAR(meshVolume(mesh), 1.0, 0.12);
  EXPECT_TRUE(inspectSurface(boundarySurface(mesh)).closedManifold());
  const std::vector<double> zeros(static_cast<std::size_t>(lattice.points()), 0.0);
  EXPECT_TRUE(stuff(lattice, zeros, 0.0).tetrahedron.empty());
}

TEST(BoundaryTriangles, AreOutwardSortedAndOwned) {
  TetrahedralMesh mesh;
  mesh.vertex = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), Vec3::Ones()};
  mesh.tetrahedron = {Index4(0, 1, 2, 3), Index4(1, 2, 3, 4)};
  ASSERT_GT(volumeOf(mesh, mesh.tetrahedron[0]), 0.0);
  ASSERT_GT(volumeOf(mesh, mesh.tetrahedron[1]), 0.0);
  const std::vector<BoundaryTriangle> boundary = boundaryTriangles(mesh);
  ASSERT_EQ(boundary.size(), 6U);
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const Index3& v = boundary[i].vertex;
    EXPECT_EQ(v[0], v.minCoeff());
    EXPECT_EQ(boundary[i].tetrahedron, v.maxCoeff() == 4 ? 1 : 0);
    if (i > 0) {
      EXPECT_TRUE(std::lexicographical_compare(boundary[i - 1].vertex.data(), boundary[i - 1].vertex.data() + 3,
                                               v.data(), v.data() + 3));
    }
  }
  EXPECT_TRUE(inspectSurface(boundarySurface(mesh)).closedManifold());
  int count = 0;
  EXPECT_EQ(tetrahedronComponents(mesh, count), (std::vector<int>{0, 0}));
  EXPECT_EQ(count, 1);
}

TEST(DihedralRange, RegularTetrahedron) {
  TetrahedralMesh mesh;
  mesh.vertex = {Vec3(1.0, 1.0, 1.0), Vec3(1.0, -1.0, -1.0), Vec3(-1.0, 1.0, -1.0), Vec3(-1.0, -1.0, 1.0)};
  mesh.tetrahedron = {Index4(0, 1, 3, 2)};
  if (volumeOf(mesh, mesh.tetrahedron[0]) < 0.0) std::swap(mesh.tetrahedron[0][2], mesh.tetrahedron[0][3]);
  EXPECT_NEAR(dihedralRange(mesh).min, std::acos(1.0 / 3.0), 1e-14);
  EXPECT_NEAR(dihedralRange(mesh).max, std::acos(1.0 / 3.0), 1e-14);
  EXPECT_NEAR(meshVolume(mesh), 8.0 / 3.0, 1e-14);
}

}  // namespace
}  // namespace calot

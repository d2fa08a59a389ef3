// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <set>

#include "sim/geometry/surface_report.h"
#include "tests/sim/carving/support/carving_bodies.h"

namespace calot {
namespace {

TEST(CubeTable, EveryCaseIsClosedAgainstItsNeighboursAndOutward) {
  const CubeTable& table = CubeTable::get();
  std::size_t most = 0;
  for (unsigned inside = 0; inside < 256; ++inside) {
    const CubeCase& c = table[inside];
    most = std::max<std::size_t>(most, c.count);
    std::set<unsigned> used;
    for (std::size_t t = 0; t < c.count; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const unsigned e = c.edge[t][k];
        used.insert(e);
        const unsigned a = e / 4;
        const unsigned low = (e & 1U) << (a + 1) % 3 | (e >> 1U & 1U) << (a + 2) % 3;
        EXPECT_NE(inside >> low & 1U, inside >> (low | 1U << a) & 1U);  // only cut edges
        // A side on a face is met by the cell beyond, whose case agrees on that face's corners: no chord of either.
        if (c.across[t][k] >= 0) {
          EXPECT_EQ(facesOfEdge(e) & facesOfEdge(c.edge[t][(k + 1) % 3]), 0U);
        }
      }
    }
    unsigned cut = 0;
    for (unsigned e = 0; e < 12; ++e) {
      const unsigned a = e / 4;
      const unsigned low = (e & 1U) << (a + 1) % 3 | (e >> 1U & 1U) << (a + 2) % 3;
      cut += (inside >> low & 1U) != (inside >> (low | 1U << a) & 1U) ? 1 : 0;
    }
    EXPECT_EQ(used.size(), cut);
  }
  EXPECT_EQ(most, CubeCase::maxTriangles);
}

TEST(CarvedSurface, IsTheBodysSurface) {
  for (const int nodes : {33, 65}) {
    const BrickLattice lattice(Vec3::Constant(-1.2), 2.4 / (nodes - 1), Index3::Constant(nodes));
    const FieldModel model = test::fieldOf(lattice, 3.0, [](const Vec3& p) { return p.norm() - 1.0; });
    const CarvedField field(model);
    CarvedSurface surface(lattice);
    surface.rebuild(field);
    const TriangleMesh mesh = test::meshOf(field, surface);
    EXPECT_EQ(mesh.triangle.size(), surface.triangles());
    const SurfaceReport report = inspectSurface(mesh);
    EXPECT_TRUE(report.closedManifold());
    EXPECT_EQ(report.components, 1);
    EXPECT_NEAR(report.volume, 4.18879, 60.0 / (nodes * nodes));
    AdaptiveSurface adaptive(lattice);
    adaptive.rebuild(field);
    const SurfaceReport coarse = inspectSurface(adaptive.mesh());
    EXPECT_TRUE(coarse.closedManifold());
    EXPECT_EQ(coarse.components, 1);
    EXPECT_NEAR(coarse.volume, 4.18879, 200.0 / (nodes * nodes));
    EXPECT_LT(static_cast<double>(adaptive.triangles()), 0.4 * static_cast<double>(surface.triangles()));
    // Its vertices lie on the surface but for clamped cuts, its normals point outward.
    double worst = 0.0;
    for (std::uint32_t b = 0; b < adaptive.blocks(); ++b) {
      for (const AdaptiveSurface::Vertex& v : adaptive.part(b).vertex) {
        worst = std::max(worst, std::abs(v.position.norm() - 1.0) / lattice.cell());
        EXPECT_GT(v.normal.dot(v.position.normalized()), 0.97);
      }
    }
    EXPECT_LT(worst, 0.16);
  }
}

TEST(CarvedSurface, CutsKeepAwayFromTheNodes) {
  Random random(2, 9);
  const FieldModel model = test::noise(random, 20);
  const CarvedField field(model);
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  double least = 1.0;
  test::forEachPatch(surface, [&](const SurfacePatch& p) {
    EXPECT_LE(p.triangleCount, SurfacePatch::maxTriangles);
    for (std::size_t i = 0; i < p.vertexCount; ++i) {
      const double t = surface_vertex::cut(field, p.vertex[i]);
      least = std::min({least, t, 1.0 - t});
    }
  });
  EXPECT_EQ(least, surface_vertex::minCut);
}

TEST(CarvedSurface, LeastAngleOfACarvedBody) {
  const FieldModel model = test::lump(65);
  CarvedField field(model);
  CarvedBricks state;
  Random random(6, 6);
  std::cout << "seed 6\n";
  const Box box{{-0.02, -0.015, -0.004}, {0.02, 0.015, 0.008}};
  for (int i = 0; i < 40; ++i) {
    field.begin();
    test::carveAtRest(field, {test::randomSweep(random, box, 0.0015, 0.004, 0.002)});
    field.commit(state);
  }
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  double largest = -1.0;  // cosine
  const TriangleMesh mesh = test::meshOf(field, surface);
  for (int t = 0; t < mesh.triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
      const Vec3 v = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
      largest = std::max(largest, u.dot(v) / (u.norm() * v.norm()));
    }
  }
  const double degrees = std::acos(largest) * 180.0 / 3.14159265358979;
  std::cout << mesh.triangles() << " triangles, least angle " << degrees << " degrees\n";
  EXPECT_GT(degrees, 7.0);
}

/// Adjacency from signs alone against the list of triangles.
void expectAdjacency(const FieldModel& model) {
  const CarvedField field(model);
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  const SurfaceAdjacency adjacency(field);
  std::size_t triangles = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cornerOf;  // vertex, triangle
  test::forEachPatch(surface, [&](const SurfacePatch& p) {
    for (std::size_t t = 0; t < p.triangleCount; ++t) {
      ++triangles;
      const std::uint32_t name = p.triangle[t];
      ASSERT_TRUE(adjacency.exists(name));
      const std::array<std::uint32_t, 3> v = adjacency.vertices(name);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(v[k], p.vertexOf(t, k));
        cornerOf.emplace_back(v[k], name);
        const std::uint32_t other = adjacency.across(name, k);
        ASSERT_NE(other, name);
        const std::array<std::uint32_t, 3> w = adjacency.vertices(other);
        bool met = false;
        for (std::size_t j = 0; j < 3; ++j) {
          if (w[j] != v[(k + 1) % 3] || w[(j + 1) % 3] != v[k]) continue;
          met = true;
          ASSERT_EQ(adjacency.across(other, j), name);
        }
        ASSERT_TRUE(met);
      }
    }
  });
  EXPECT_GT(triangles, 50U);
  std::sort(cornerOf.begin(), cornerOf.end());
  for (std::size_t i = 0; i < cornerOf.size();) {
    std::vector<std::uint32_t> expected;
    const std::uint32_t vertex = cornerOf[i].first;
    for (; i < cornerOf.size() && cornerOf[i].first == vertex; ++i) expected.push_back(cornerOf[i].second);
    std::array<std::uint32_t, SurfaceAdjacency::maxAround> around{};
    const std::size_t count = adjacency.around(vertex, around);
    std::vector<std::uint32_t> got(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(count));
    std::sort(got.begin(), got.end());
    ASSERT_EQ(got, expected);
    // One closed fan: going across the sides at the vertex meets them all.
    std::uint32_t t = expected[0];
    std::size_t steps = 0;
    do {
      const std::array<std::uint32_t, 3> v = adjacency.vertices(t);
      const auto k = static_cast<std::size_t>(std::find(v.begin(), v.end(), vertex) - v.begin());
      t = adjacency.across(t, k);
      ++steps;
    } while (t != expected[0] && steps < 100);
    ASSERT_EQ(steps, expected.size());
  }
  EXPECT_FALSE(adjacency.exists(static_cast<std::uint32_t>(8 * model.lattice.storage())));
}

TEST(SurfaceAdjacency, AgreesWithTheTriangles) {
  expectAdjacency(test::lump(41));
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed, 10);
    ASSERT_NO_FATAL_FAILURE(expectAdjacency(test::noise(random, 8 + static_cast<int>(seed))));
  }
}

}  // namespace
}  // namespace calot

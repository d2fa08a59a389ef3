// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/sim/carving/support/carving_bodies.h"

namespace calot {
namespace {

TEST(AdaptiveSurface, HasAtMostFortyPercentOfTheTrianglesAndStaysNearTheSurface) {
  for (const int nodes : {64, 128}) {
    const FieldModel model = test::lump(nodes);
    CarvedField field(model);
    CarvedBricks state;
    CarvedSurface surface(model.lattice);
    surface.rebuild(field);
    AdaptiveSurface adaptive(model.lattice);
    adaptive.rebuild(field);
    Random random(21, 2);
    std::cout << "seed 21\n";
    const Box box{{-0.02, -0.015, 0.004}, {0.02, 0.015, 0.008}};
    double largest = 0.0;
    for (int i = 0; i < 60; ++i) {
      field.begin();
      test::carveAtRest(field, {test::randomSweep(random, box, 0.0015, 0.004, random.uniform(0.001, 0.002))});
      field.commit(state);
      surface.update(field);
      adaptive.update(field);
      largest = std::max(largest, static_cast<double>(adaptive.triangles()) / static_cast<double>(surface.triangles()));
    }
    EXPECT_LE(largest, 0.40);

    // Middles of triangles against the field.
    const TriangleMesh mesh = adaptive.mesh();
    std::vector<double> off;
    for (int t = 0; t < mesh.triangles(); ++t) {
      const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      const FieldSample s = sampleField(field, (middle - model.lattice.origin()) / model.lattice.cell());
      off.push_back(std::abs(s.value) / model.lattice.cell());
    }
    std::sort(off.begin(), off.end());
    std::cout << nodes << "^3: " << adaptive.triangles() << " triangles, at most " << 100.0 * largest
              << " % of the fast surface's; middles off by " << off[off.size() / 2] << " cells (median), "
              << off[off.size() * 99 / 100] << " (99 %), " << off.back() << " (all)\n";
    EXPECT_LT(off[off.size() / 2], 0.1);
    EXPECT_LT(off[off.size() * 99 / 100], 0.75);  // ridges between grooves
  }
}

TEST(AdaptiveSurface, AVertexIsTheSameInEveryPart) {
  const FieldModel model = test::lump(64);
  const CarvedField field(model);
  AdaptiveSurface adaptive(model.lattice);
  adaptive.rebuild(field);
  std::vector<std::pair<std::uint64_t, Vec3>> all;
  for (std::uint32_t b = 0; b < adaptive.blocks(); ++b) {
    for (const AdaptiveSurface::Vertex& v : adaptive.part(b).vertex) all.emplace_back(v.key, v.position);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::size_t shared = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].first != all[i - 1].first) continue;
    ++shared;
    EXPECT_EQ(all[i].second, all[i - 1].second);
  }
  EXPECT_GT(shared, 1000U);
}

}  // namespace
}  // namespace calot

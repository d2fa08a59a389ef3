// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's Fig. 5 in figures: the same strokes on a potential field and on tetrahedra.
#include <gtest/gtest.h>

#include <iostream>

#include "sim/carving/carved_field.h"
#include "sim/geometry/surface_report.h"
#include "tests/sim/carving/support/carving_bodies.h"
#include "tests/sim/carving/support/tetrahedra_removal.h"

namespace calot {
namespace {

constexpr int strokes = 90;

/// Parts of a closed surface that enclose something, besides the largest.
int smallClusters(const TriangleMesh& mesh) {
  const SurfaceReport report = inspectSurface(mesh);
  return report.components - report.cavities - report.inwardComponents - 1;
}

TEST(Comparison, FieldAgainstRemovalOfTetrahedra) {
  const std::uint64_t seed = 5;
  std::cout << "seed " << seed << ", " << strokes << " strokes of radius 1.5 mm\n"
            << "method                     cell (mm)  elements  small clusters  dangling  open edges\n";
  for (const double cell : {0.004, 0.0025, 0.0015}) {
    Random random(seed, 11);
    test::TetrahedraRemoval baseline({{-0.020, -0.015, -0.008}, {0.020, 0.0151, 0.0081}}, cell, test::insideSlab);
    for (int i = 0; i < strokes; ++i) baseline.stroke(test::slabStroke(random));
    const test::TetrahedraRemoval::Quality q = baseline.quality();
    std::cout << "removal of tetrahedra      " << 1e3 * cell << "        " << q.tetrahedra << "      "
              << q.smallClusters << "              " << q.dangling << "\n";
    EXPECT_GT(q.smallClusters, 3);
    EXPECT_GT(q.dangling, 20);
  }
  for (const bool removeIslands : {false, true}) {
    for (const int nodes : {33, 65}) {
      Random random(seed, 11);
      const BrickLattice lattice(Vec3::Constant(-0.024), 0.048 / (nodes - 1), Index3::Constant(nodes));
      const FieldModel model = test::fieldOf(lattice, 3.0, test::slabDistance);
      CarvedField field(model);
      CarvedBricks state;
      Islands islands(lattice, test::floorAnchors(lattice));
      islands.rebuild(field);
      for (int i = 0; i < strokes; ++i) {
        field.begin();
        test::carveAtRest(field, test::slabStroke(random));
        if (removeIslands) islands.remove(field);
        field.commit(state);
      }
      CarvedSurface surface(lattice);
      surface.rebuild(field);
      const TriangleMesh mesh = test::meshOf(field, surface);
      const test::EdgeFaults faults = test::edgeFaults(mesh);
      const int clusters = smallClusters(mesh);
      std::cout << (removeIslands ? "field                      " : "field, islands left        ")
                << 1e3 * lattice.cell() << "        " << mesh.triangles() << "      " << clusters << "              "
                << faults.dangling << "         " << faults.boundary << "\n";
      EXPECT_EQ(faults.dangling, 0);
      EXPECT_EQ(faults.boundary, 0);
      EXPECT_EQ(faults.nonManifold, 0);
      if (removeIslands) {
        EXPECT_EQ(clusters, 0);
      }
    }
  }
}

}  // namespace
}  // namespace calot

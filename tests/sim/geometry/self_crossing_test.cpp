// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/surface_report.h"

#include <gtest/gtest.h>

namespace calot {
namespace {

/// A tetrahedron with a corner at `at` and edges of a metre, appended.
void addTetrahedron(TriangleMesh& mesh, const Vec3& at) {
  const int n = mesh.vertices();
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) mesh.vertex.push_back(at + p);
  for (const Index3& t : {Index3(0, 2, 1), Index3(0, 1, 3), Index3(0, 3, 2), Index3(1, 2, 3)}) {
    mesh.triangle.push_back(t.array() + n);
  }
}

TEST(SelfCrossing, PartsThatOverlapCrossAndPartsThatAreApartDoNot) {
  TriangleMesh mesh;
  addTetrahedron(mesh, Vec3::Zero());
  EXPECT_EQ(findSelfCrossing(mesh).pairs, 0U);
  TriangleMesh apart = mesh;
  addTetrahedron(apart, Vec3(0.9, 0.9, 0.9));  // the bounds overlap, the surfaces do not
  EXPECT_EQ(findSelfCrossing(apart).pairs, 0U);
  TriangleMesh nested = mesh;
  for (const Vec3& p : mesh.vertex) nested.vertex.push_back(Vec3(0.1, 0.1, 0.1) + 0.2 * p);
  for (const Index3& t : mesh.triangle) nested.triangle.push_back(t.array() + 4);
  EXPECT_EQ(findSelfCrossing(nested).pairs, 0U);

  addTetrahedron(mesh, Vec3(0.2, 0.2, 0.1));
  const SelfCrossing found = findSelfCrossing(mesh);
  EXPECT_GE(found.pairs, 3U);
  EXPECT_TRUE((found.first < 4) != (found.second < 4));
  // The named place is on the first part's slope and on the second's surface.
  EXPECT_NEAR(found.where.sum(), 1.0, 1e-12);
  EXPECT_EQ(findSelfCrossing(mesh, 2).pairs, 2U);
}

TEST(SelfCrossing, AFoldOfOneSurfaceIsFound) {
  // A tetrahedron whose fan is finer, one vertex of it pushed out through the opposite side.
  TriangleMesh mesh;
  mesh.vertex = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.2, -0.5}};
  mesh.triangle = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}};
  EXPECT_EQ(findSelfCrossing(mesh).first >= 0, true);
  mesh.vertex[4] = Vec3(0.4, 0.4, 0.4);
  EXPECT_EQ(findSelfCrossing(mesh).pairs, 0U);
}

}  // namespace
}  // namespace calot

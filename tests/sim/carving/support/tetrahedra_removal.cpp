// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/carving/support/tetrahedra_removal.h"

#include <algorithm>
#include <array>

#include "sim/geometry/closest_point.h"

namespace calot::test {
namespace {

Vec3 centroid(const TetrahedralMesh& mesh, const Index4& t) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) sum += mesh.vertex[slot(t[k])];
  return 0.25 * sum;
}

}  // namespace

TetrahedraRemoval::TetrahedraRemoval(const Box& box, double cell, bool (*inside)(const Vec3&)) {
  const Index3 cubes = ((box.upper - box.lower) / cell).array().ceil().cast<int>();
  const Index3 nodes = cubes.array() + 1;
  const auto node = [&](const Index3& n) { return n[0] + nodes[0] * (n[1] + nodes[1] * n[2]); };
  Index3 n;
  for (n[2] = 0; n[2] < nodes[2]; ++n[2]) {
    for (n[1] = 0; n[1] < nodes[1]; ++n[1]) {
      for (n[0] = 0; n[0] < nodes[0]; ++n[0]) mesh_.vertex.push_back(box.lower + cell * n.cast<double>());
    }
  }
  // Kuhn: one tetrahedron for each order in which the axes lead from corner 000 to corner 111.
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (n[2] = 0; n[2] < cubes[2]; ++n[2]) {
    for (n[1] = 0; n[1] < cubes[1]; ++n[1]) {
      for (n[0] = 0; n[0] < cubes[0]; ++n[0]) {
        for (const auto& order : orders) {
          Index3 at = n;
          Index4 t;
          t[0] = node(at);
          for (int k = 0; k < 3; ++k) {
            ++at[order[slot(k)]];
            t[k + 1] = node(at);
          }
          if (inside(centroid(mesh_, t))) mesh_.tetrahedron.push_back(t);
        }
      }
    }
  }
  kept_.assign(mesh_.tetrahedron.size(), 1);
}

void TetrahedraRemoval::stroke(std::span<const SweptCapsule> tool) {
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const Vec3 p = centroid(mesh_, mesh_.tetrahedron[i]);
    for (const SweptCapsule& c : tool) {
      const double squared = std::min(closestOnTriangle(p, c.p0, c.p1, c.q1).squaredDistance,
                                      closestOnTriangle(p, c.p0, c.q1, c.q0).squaredDistance);
      if (squared < c.radius * c.radius) kept_[i] = 0;
    }
  }
}

TetrahedraRemoval::Quality TetrahedraRemoval::quality() const {
  const TetrahedralMesh rest = subMesh(mesh_, kept_);
  Quality q;
  q.tetrahedra = static_cast<int>(rest.tetrahedron.size());
  int parts = 0;
  (void)tetrahedronComponents(rest, parts);
  q.smallClusters = std::max(0, parts - 1);
  std::vector<int> open(rest.tetrahedron.size(), 0);
  for (const BoundaryTriangle& t : boundaryTriangles(rest)) ++open[slot(t.tetrahedron)];
  for (const int faces : open) q.dangling += faces >= 3 ? 1 : 0;
  return q;
}

TriangleMesh TetrahedraRemoval::faces() const {
  const TetrahedralMesh rest = subMesh(mesh_, kept_);
  TriangleMesh out;
  for (const BoundaryTriangle& t : boundaryTriangles(rest)) {
    const auto first = static_cast<int>(out.vertex.size());
    for (int k = 0; k < 3; ++k) out.vertex.push_back(rest.vertex[slot(t.vertex[k])]);
    out.triangle.emplace_back(first, first + 1, first + 2);
  }
  return out;
}

}  // namespace calot::test

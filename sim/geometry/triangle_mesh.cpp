// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/triangle_mesh.h"

#include <algorithm>
#include <tuple>

namespace calot {

double surfaceArea(const TriangleMesh& mesh) {
  double doubled = 0.0;
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    doubled += (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm();
  }
  return 0.5 * doubled;
}

double signedVolume(const TriangleMesh& mesh) {
  if (mesh.vertex.empty()) return 0.0;
  const Box box = bounds(mesh);
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  double six = 0.0;
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Vec3 a = mesh.corner(t, 0) - middle;
    const Vec3 b = mesh.corner(t, 1) - middle;
    const Vec3 c = mesh.corner(t, 2) - middle;
    six += a.dot(b.cross(c));
  }
  return six / 6.0;
}

Box bounds(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.vertex) box.include(p);
  return box;
}

std::vector<TriangleSide> sortedSides(const TriangleMesh& mesh) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * mesh.triangle.size());
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Index3& v = mesh.triangle[slot(t)];
    for (int k = 0; k < 3; ++k) {
      const int from = v[k];
      const int to = v[(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& x, const TriangleSide& y) {
    return std::tie(x.low, x.high, x.triangle, x.side) < std::tie(y.low, y.high, y.triangle, y.side);
  });
  return sides;
}

std::vector<Index3> triangleNeighbours(const TriangleMesh& mesh) {
  std::vector<Index3> neighbour(mesh.triangle.size(), Index3::Constant(-1));
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    if (sides.size() != 2) return;
    neighbour[slot(sides[0].triangle)][sides[0].side] = sides[1].triangle;
    neighbour[slot(sides[1].triangle)][sides[1].side] = sides[0].triangle;
  });
  return neighbour;
}

std::vector<int> triangleComponents(const TriangleMesh& mesh, int& count) {
  std::vector<int> parent(mesh.triangle.size());
  for (std::size_t t = 0; t < parent.size(); ++t) parent[t] = static_cast<int>(t);
  const auto root = [&parent](int t) {
    while (parent[slot(t)] != t) {
      parent[slot(t)] = parent[slot(parent[slot(t)])];
      t = parent[slot(t)];
    }
    return t;
  };
  const std::vector<TriangleSide> sides = sortedSides(mesh);
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].low != sides[i - 1].low || sides[i].high != sides[i - 1].high) continue;
    const int x = root(sides[i - 1].triangle);
    const int y = root(sides[i].triangle);
    parent[slot(std::max(x, y))] = std::min(x, y);
  }
  // A root is its component's smallest triangle, so it precedes the others.
  count = 0;
  std::vector<int> component(mesh.triangle.size(), -1);
  for (int t = 0; t < mesh.triangles(); ++t) {
    const int r = root(t);
    if (r == t) component[slot(t)] = count++;
    component[slot(t)] = component[slot(r)];
  }
  return component;
}

}  // namespace calot

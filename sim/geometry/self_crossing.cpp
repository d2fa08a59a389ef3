// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/self_crossing.h"

#include <algorithm>
#include <vector>

#include "sim/geometry/closest_point.h"

namespace calot {
namespace {

bool has(const Index3& triangle, int vertex) {
  return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

/// Does an edge of triangle `from` pass through triangle `through`? Edges that share a vertex with it start on
/// it and are skipped.
bool passes(const TriangleMesh& mesh, int from, int through, Vec3& where) {
  for (int k = 0; k < 3; ++k) {
    const int a = mesh.triangle[slot(from)][k];
    const int b = mesh.triangle[slot(from)][(k + 1) % 3];
    if (has(mesh.triangle[slot(through)], a) || has(mesh.triangle[slot(through)], b)) continue;
    const SegmentTriangle found =
        closestSegmentTriangle(mesh.vertex[slot(a)], mesh.vertex[slot(b)], mesh.corner(through, 0),
                               mesh.corner(through, 1), mesh.corner(through, 2));
    if (!found.crosses) continue;
    where = found.onTriangle;
    return true;
  }
  return false;
}

}  // namespace

SelfCrossing findSelfCrossing(const TriangleMesh& mesh, std::size_t maxPairs) {
  struct Bounds {
    Vec3 lower, upper;
    int triangle;
  };
  SelfCrossing result;
  std::vector<Bounds> all;
  all.reserve(mesh.triangle.size());
  for (int t = 0; t < mesh.triangles(); ++t) {
    all.push_back({mesh.corner(t, 0).cwiseMin(mesh.corner(t, 1)).cwiseMin(mesh.corner(t, 2)),
                   mesh.corner(t, 0).cwiseMax(mesh.corner(t, 1)).cwiseMax(mesh.corner(t, 2)), t});
  }
  const Box box = bounds(mesh);
  int axis = 0;
  static_cast<void>((box.upper - box.lower).maxCoeff(&axis));
  std::sort(all.begin(), all.end(), [axis](const Bounds& x, const Bounds& y) {
    return x.lower[axis] != y.lower[axis] ? x.lower[axis] < y.lower[axis] : x.triangle < y.triangle;
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size() && all[j].lower[axis] <= all[i].upper[axis]; ++j) {
      if ((all[j].lower.array() > all[i].upper.array()).any() || (all[i].lower.array() > all[j].upper.array()).any()) {
        continue;
      }
      const int s = all[i].triangle;
      const int t = all[j].triangle;
      Vec3 where = Vec3::Zero();
      if (!passes(mesh, s, t, where) && !passes(mesh, t, s, where)) continue;
      if (result.pairs == 0) {
        result.first = s;
        result.second = t;
        result.where = where;
      }
      if (++result.pairs >= maxPairs) return result;
    }
  }
  return result;
}

}  // namespace calot

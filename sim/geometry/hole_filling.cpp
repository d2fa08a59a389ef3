// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/surface_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace calot {
namespace {

using EdgeKey = std::pair<int, int>;

EdgeKey edgeKey(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Twice the area as a vector.
Vec3 crossOf(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// 1 - cos of the angle between two normals, 0 to 2; what has no normal bends as far as can be.
double bendBetween(const Vec3& n, const Vec3& m) {
  const double lengths = std::sqrt(n.squaredNorm() * m.squaredNorm());
  return lengths > 0.0 ? 1.0 - n.dot(m) / lengths : 2.0;
}

/// How many sides each edge has, and which of the open ones follows which round its hole.
class OpenEdges {
 public:
  explicit OpenEdges(const TriangleMesh& mesh)
      : mesh_(mesh), neighbour_(triangleNeighbours(mesh)), open_(mesh.triangle.size(), {0, 0, 0}) {
    forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
      if (sides.size() == 1) open_[slot(sides[0].triangle)][sides[0].side] = 1;
    });
  }

  [[nodiscard]] bool isOpen(int triangle, int side) const { return open_[slot(triangle)][side] == 1; }

  /// From an open side on to the one that begins where it ends, around that vertex. @return false: there is no way
  bool advance(int& triangle, int& side) const {
    const int pivot = mesh_.triangle[slot(triangle)][(side + 1) % 3];
    int at = triangle, k = (side + 1) % 3;
    for (int turns = 0; turns <= mesh_.triangles(); ++turns) {
      if (isOpen(at, k)) {
        triangle = at;
        side = k;
        return true;
      }
      const int next = neighbour_[slot(at)][k];
      if (next < 0) return false;
      const Index3& v = mesh_.triangle[slot(next)];
      int j = 0;
      while (j < 3 && v[j] != pivot) ++j;
      // Beyond the shared edge, which runs into the vertex where both triangles agree on what is outside.
      if (j == 3 || v[(j + 2) % 3] != mesh_.triangle[slot(at)][(k + 1) % 3]) return false;
      at = next;
      k = j;
    }
    return false;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<Index3> neighbour_;
  std::vector<Index3> open_;
};

void measure(const TriangleMesh& mesh, SurfaceHole& hole) {
  for (std::size_t i = 0; i < hole.vertex.size(); ++i) {
    const Vec3& p = mesh.vertex[slot(hole.vertex[i])];
    hole.centre += p / static_cast<double>(hole.vertex.size());
    hole.perimeter += (mesh.vertex[slot(hole.vertex[(i + 1) % hole.vertex.size()])] - p).norm();
  }
}

/// Divides a loop where it passes a vertex again.
void divideLoop(const std::vector<int>& loop, std::vector<SurfaceHole>& holes) {
  std::vector<int> path;
  for (const int v : loop) {
    const auto before = std::find(path.begin(), path.end(), v);
    if (before != path.end()) {
      holes.emplace_back().vertex.assign(before, path.end());
      path.erase(before, path.end());
    }
    path.push_back(v);
  }
  if (!path.empty()) holes.emplace_back().vertex = std::move(path);
}

/// The best triangulation of the vertices from i to j of a loop: its sharpest edge, its area, and the third corner
/// of the triangle on (i, j).
struct Best {
  double bend = std::numeric_limits<double>::infinity();
  double area = 0.0;
  int apex = -1;

  [[nodiscard]] bool betterThan(const Best& other) const {
    return bend < other.bend || (bend == other.bend && area < other.area);
  }
};

class Triangulation {
 public:
  /// @param outside normals of the triangles beyond the loop's edges, edge i from vertex i to i + 1
  Triangulation(const TriangleMesh& mesh, const std::vector<int>& loop, std::vector<Vec3> outside,
                const std::set<EdgeKey>& taken)
      : mesh_(mesh), loop_(loop), outside_(std::move(outside)), best_(loop.size() * loop.size()) {
    const int n = static_cast<int>(loop.size());
    for (int i = 0; i + 1 < n; ++i) at(i, i + 1).bend = 0.0;
    for (int length = 2; length < n; ++length) {
      for (int i = 0; i + length < n; ++i) {
        const int j = i + length;
        const bool closing = length == n - 1;
        if (!closing && taken.count(edgeKey(loop[slot(i)], loop[slot(j)])) > 0) continue;
        for (int k = i + 1; k < j; ++k) consider(i, k, j, closing);
      }
    }
  }

  [[nodiscard]] bool found() const { return std::isfinite(best_[loop_.size() - 1].bend); }

  void append(std::vector<Index3>& triangles) const {
    std::vector<std::pair<int, int>> todo{{0, static_cast<int>(loop_.size()) - 1}};
    while (!todo.empty()) {
      const auto [i, j] = todo.back();
      todo.pop_back();
      if (j - i < 2) continue;
      const int k = at(i, j).apex;
      triangles.emplace_back(loop_[slot(i)], loop_[slot(k)], loop_[slot(j)]);
      todo.emplace_back(k, j);
      todo.emplace_back(i, k);
    }
  }

 private:
  Best& at(int i, int j) { return best_[slot(i) * loop_.size() + slot(j)]; }
  [[nodiscard]] const Best& at(int i, int j) const { return best_[slot(i) * loop_.size() + slot(j)]; }
  [[nodiscard]] Vec3 normal(int i, int k, int j) const {
    return crossOf(mesh_.vertex[slot(loop_[slot(i)])], mesh_.vertex[slot(loop_[slot(k)])],
                   mesh_.vertex[slot(loop_[slot(j)])]);
  }
  /// Normal beyond the edge from i to j.
  [[nodiscard]] Vec3 beyond(int i, int j) const { return j == i + 1 ? outside_[slot(i)] : normal(i, at(i, j).apex, j); }

  void consider(int i, int k, int j, bool closing) {
    const Best &left = at(i, k), &right = at(k, j);
    Best& best = at(i, j);
    const double least = std::max(left.bend, right.bend);
    if (!(least <= best.bend) || !std::isfinite(least)) return;
    const Vec3 own = normal(i, k, j);
    Best tried;
    tried.bend = std::max({least, bendBetween(own, beyond(i, k)), bendBetween(own, beyond(k, j))});
    if (closing) tried.bend = std::max(tried.bend, bendBetween(own, outside_.back()));
    tried.area = left.area + right.area + 0.5 * own.norm();
    tried.apex = k;
    if (tried.betterThan(best)) best = tried;
  }

  const TriangleMesh& mesh_;
  const std::vector<int>& loop_;
  std::vector<Vec3> outside_;
  std::vector<Best> best_;
};

}  // namespace

std::vector<SurfaceHole> findHoles(const TriangleMesh& mesh) {
  const OpenEdges edges(mesh);
  std::vector<Index3> passed(mesh.triangle.size(), {0, 0, 0});
  std::vector<SurfaceHole> holes;
  for (int t = 0; t < mesh.triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (!edges.isOpen(t, k) || passed[slot(t)][k] == 1) continue;
      std::vector<int> loop;
      int at = t, side = k;
      bool closed = false;
      do {
        passed[slot(at)][side] = 1;
        loop.push_back(mesh.triangle[slot(at)][side]);
        closed = edges.advance(at, side);
      } while (closed && passed[slot(at)][side] == 0);
      if (!closed || at != t || side != k) continue;
      // Triangles beside a hole go round it the other way.
      std::reverse(loop.begin(), loop.end());
      divideLoop(loop, holes);
    }
  }
  for (SurfaceHole& hole : holes) {
    std::rotate(hole.vertex.begin(), std::min_element(hole.vertex.begin(), hole.vertex.end()), hole.vertex.end());
    measure(mesh, hole);
  }
  std::sort(holes.begin(), holes.end(), [](const SurfaceHole& a, const SurfaceHole& b) { return a.vertex < b.vertex; });
  return holes;
}

HoleFilling fillHoles(const TriangleMesh& mesh) {
  HoleFilling filling{mesh, findHoles(mesh)};
  std::set<EdgeKey> taken;
  std::vector<std::pair<EdgeKey, Vec3>> rim;
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Vec3 normal = crossOf(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    for (int k = 0; k < 3; ++k) {
      const Index3& v = mesh.triangle[slot(t)];
      taken.insert(edgeKey(v[k], v[(k + 1) % 3]));
      rim.emplace_back(edgeKey(v[k], v[(k + 1) % 3]), normal);
    }
  }
  const auto first = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(rim.begin(), rim.end(), first);
  for (SurfaceHole& hole : filling.holes) {
    const std::size_t edges = hole.vertex.size();
    if (edges > slot(maxHoleEdges)) {
      hole.fault = "more than " + std::to_string(maxHoleEdges) + " edges";
      continue;
    }
    std::vector<Vec3> outside(edges);
    for (std::size_t i = 0; i < edges; ++i) {
      const std::pair<EdgeKey, Vec3> edge{edgeKey(hole.vertex[i], hole.vertex[(i + 1) % edges]), Vec3::Zero()};
      outside[i] = std::lower_bound(rim.begin(), rim.end(), edge, first)->second;
    }
    const std::size_t before = filling.mesh.triangle.size();
    if (const Triangulation best(mesh, hole.vertex, std::move(outside), taken); best.found()) {
      best.append(filling.mesh.triangle);
    } else {
      const int centre = filling.mesh.vertices();
      filling.mesh.vertex.push_back(hole.centre);
      for (std::size_t i = 0; i < edges; ++i)
        filling.mesh.triangle.emplace_back(hole.vertex[i], hole.vertex[(i + 1) % edges], centre);
    }
    for (std::size_t t = before; t < filling.mesh.triangle.size(); ++t) {
      const Index3& v = filling.mesh.triangle[t];
      for (int k = 0; k < 3; ++k) taken.insert(edgeKey(v[k], v[(k + 1) % 3]));
      const int number = static_cast<int>(t);
      hole.area +=
          0.5 * crossOf(filling.mesh.corner(number, 0), filling.mesh.corner(number, 1), filling.mesh.corner(number, 2))
                    .norm();
    }
  }
  return filling;
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/surface_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/geometry/closest_point.h"
#include "sim/math/elementary.h"

namespace calot {
namespace {

constexpr double straightAngle = 3.14159265358979323846;

bool before(const Vec3& x, const Vec3& y) {
  for (int k = 0; k < 3; ++k) {
    if (x[k] != y[k]) return x[k] < y[k];
  }
  return false;
}

/// For each vertex the smallest index at exactly its position.
std::vector<int> firstCoincident(const TriangleMesh& mesh) {
  std::vector<int> order(mesh.vertex.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&mesh](int x, int y) {
    const Vec3& p = mesh.vertex[slot(x)];
    const Vec3& q = mesh.vertex[slot(y)];
    if (before(p, q)) return true;
    if (before(q, p)) return false;
    return x < y;
  });
  std::vector<int> first(mesh.vertex.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.vertex[slot(order[i])] == mesh.vertex[slot(order[i - 1])];
    first[slot(order[i])] = same ? first[slot(order[i - 1])] : order[i];
  }
  return first;
}

Index3 sorted(Index3 v) {
  std::sort(v.data(), v.data() + 3);
  return v;
}

/// duplicate[t] != 0: an earlier triangle has the same three vertices.
std::vector<char> duplicates(const TriangleMesh& mesh) {
  std::vector<std::pair<std::array<int, 3>, int>> key(mesh.triangle.size());
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Index3 v = sorted(mesh.triangle[slot(t)]);
    key[slot(t)] = {{v[0], v[1], v[2]}, t};
  }
  std::sort(key.begin(), key.end());
  std::vector<char> duplicate(mesh.triangle.size(), 0);
  for (std::size_t i = 1; i < key.size(); ++i) {
    if (key[i].first == key[i - 1].first) duplicate[slot(key[i].second)] = 1;
  }
  return duplicate;
}

bool repeatsCorner(const Index3& v) { return v[0] == v[1] || v[1] == v[2] || v[2] == v[0]; }

/// Is the height over the longest side negligible compared with that side?
bool isDegenerate(const TriangleMesh& mesh, int t) {
  if (repeatsCorner(mesh.triangle[slot(t)])) return true;
  const Vec3& a = mesh.corner(t, 0);
  const Vec3& b = mesh.corner(t, 1);
  const Vec3& c = mesh.corner(t, 2);
  const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > 1e-10 * longest2);
}

/// Winding number of the triangles of one component around p, without approximation.
double componentWinding(const TriangleMesh& mesh, const std::vector<int>& triangles, const Vec3& p) {
  double sum = 0.0;
  for (const int t : triangles) {
    const Vec3 x = mesh.corner(t, 0) - p;
    const Vec3 y = mesh.corner(t, 1) - p;
    const Vec3 z = mesh.corner(t, 2) - p;
    const double lx = x.norm();
    const double ly = y.norm();
    const double lz = z.norm();
    sum += 2.0 * arctangent2(x.dot(y.cross(z)), lx * ly * lz + x.dot(y) * lz + y.dot(z) * lx + z.dot(x) * ly);
  }
  return sum / (4.0 * straightAngle);
}

struct Component {
  std::vector<int> triangle;
  Box box;
  bool clean = true;    ///< closed, manifold, consistent
  double volume = 0.0;  ///< signed
};

std::vector<Component> components(const TriangleMesh& mesh) {
  int count = 0;
  const std::vector<int> of = triangleComponents(mesh, count);
  std::vector<Component> result(slot(count));
  for (int t = 0; t < mesh.triangles(); ++t) {
    Component& c = result[slot(of[slot(t)])];
    c.triangle.push_back(t);
    for (int k = 0; k < 3; ++k) c.box.include(mesh.corner(t, k));
  }
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    const bool good = sides.size() == 2 && sides[0].forward != sides[1].forward;
    if (!good) result[slot(of[slot(sides[0].triangle)])].clean = false;
  });
  for (Component& c : result) {
    const Vec3 middle = 0.5 * (c.box.lower + c.box.upper);
    for (const int t : c.triangle) {
      c.volume +=
          (mesh.corner(t, 0) - middle).dot((mesh.corner(t, 1) - middle).cross(mesh.corner(t, 2) - middle)) / 6.0;
    }
  }
  return result;
}

/// In how many other clean components a component lies: odd, it should be a cavity.
int depth(const TriangleMesh& mesh, const std::vector<Component>& all, std::size_t which) {
  const Vec3& p = mesh.corner(all[which].triangle.front(), 0);
  int inside = 0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const bool around = (all[c].box.lower.array() <= p.array()).all() && (p.array() <= all[c].box.upper.array()).all();
    if (c == which || !all[c].clean || !around) continue;
    if (std::abs(componentWinding(mesh, all[c].triangle, p)) > 0.5) ++inside;
  }
  return inside;
}

/// Reverses triangles so that each manifold-connected group agrees with the majority of its triangles.
int makeConsistent(TriangleMesh& mesh) {
  const std::vector<Index3> neighbour = triangleNeighbours(mesh);
  std::vector<char> state(mesh.triangle.size(), 0);  // 0 not visited, 1 unchanged, 2 reversed
  std::vector<int> queue;
  int flipped = 0;
  for (int seed = 0; seed < mesh.triangles(); ++seed) {
    if (state[slot(seed)] != 0) continue;
    state[slot(seed)] = 1;
    queue.assign(1, seed);
    int as = 0;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const int t = queue[head];
      if (state[slot(t)] == 1) ++as;
      const Index3& v = mesh.triangle[slot(t)];
      for (int k = 0; k < 3; ++k) {
        const int other = neighbour[slot(t)][k];
        if (other < 0 || state[slot(other)] != 0) continue;
        const Index3& w = mesh.triangle[slot(other)];
        bool sameDirection = false;
        for (int j = 0; j < 3; ++j) sameDirection = sameDirection || (w[j] == v[k] && w[(j + 1) % 3] == v[(k + 1) % 3]);
        const char agree = state[slot(t)];
        state[slot(other)] = sameDirection ? static_cast<char>(3 - agree) : agree;
        queue.push_back(other);
      }
    }
    // Reverse the minority.
    const char flip = 2 * as >= static_cast<int>(queue.size()) ? char{2} : char{1};
    for (const int t : queue) {
      if (state[slot(t)] != flip) continue;
      std::swap(mesh.triangle[slot(t)][1], mesh.triangle[slot(t)][2]);
      ++flipped;
    }
  }
  return flipped;
}

}  // namespace

SurfaceReport inspectSurface(const TriangleMesh& mesh) {
  SurfaceReport report;
  report.vertices = mesh.vertices();
  report.triangles = mesh.triangles();
  report.area = surfaceArea(mesh);
  report.volume = signedVolume(mesh);
  report.box = bounds(mesh);

  std::vector<char> used(mesh.vertex.size(), 0);
  for (const Index3& v : mesh.triangle) {
    for (int k = 0; k < 3; ++k) used[slot(v[k])] = 1;
  }
  report.unusedVertices = static_cast<int>(std::count(used.begin(), used.end(), char{0}));
  const std::vector<int> first = firstCoincident(mesh);
  for (int i = 0; i < mesh.vertices(); ++i) report.coincidentVertices += first[slot(i)] != i ? 1 : 0;
  for (int t = 0; t < mesh.triangles(); ++t) report.degenerateTriangles += isDegenerate(mesh, t) ? 1 : 0;
  const std::vector<char> duplicate = duplicates(mesh);
  report.duplicateTriangles = static_cast<int>(std::count(duplicate.begin(), duplicate.end(), char{1}));

  // Open edges join into holes where they share a vertex.
  std::vector<int> parent(mesh.vertex.size(), -1);
  const auto root = [&parent](int v) {
    while (parent[slot(v)] != v) v = parent[slot(v)] = parent[slot(parent[slot(v)])];
    return v;
  };
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    if (sides.size() == 1) {
      ++report.openEdges;
      for (const int v : {sides[0].low, sides[0].high}) {
        if (parent[slot(v)] < 0) parent[slot(v)] = v;
      }
      const int x = root(sides[0].low);
      const int y = root(sides[0].high);
      parent[slot(std::max(x, y))] = std::min(x, y);
    } else if (sides.size() > 2) {
      ++report.nonManifoldEdges;
    } else if (sides[0].forward == sides[1].forward) {
      ++report.flippedEdges;
    }
  });
  for (int v = 0; v < mesh.vertices(); ++v) report.holes += parent[slot(v)] == v ? 1 : 0;

  const std::vector<Component> parts = components(mesh);
  report.components = static_cast<int>(parts.size());
  for (std::size_t c = 0; c < parts.size(); ++c) {
    if (!parts[c].clean) continue;
    const bool cavity = depth(mesh, parts, c) % 2 == 1;
    if (parts[c].volume < 0.0 && cavity) ++report.cavities;
    if (parts[c].volume < 0.0 && !cavity) ++report.inwardComponents;
  }
  return report;
}

SurfaceRepair repairSurface(const TriangleMesh& mesh) {
  SurfaceRepair repair;
  TriangleMesh welded = mesh;
  const std::vector<int> first = firstCoincident(mesh);
  for (int i = 0; i < mesh.vertices(); ++i) repair.weldedVertices += first[slot(i)] != i ? 1 : 0;
  for (Index3& v : welded.triangle) {
    for (int k = 0; k < 3; ++k) v[k] = first[slot(v[k])];
  }
  const std::vector<char> duplicate = duplicates(welded);
  std::vector<int> number(mesh.vertex.size(), -1);
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Index3& v = welded.triangle[slot(t)];
    if (repeatsCorner(v)) {
      ++repair.droppedDegenerate;
    } else if (duplicate[slot(t)] != 0) {
      ++repair.droppedDuplicates;
    } else {
      repair.mesh.triangle.push_back(v);
      for (int k = 0; k < 3; ++k) number[slot(v[k])] = 0;
    }
  }
  for (int i = 0; i < mesh.vertices(); ++i) {
    if (number[slot(i)] < 0) continue;
    number[slot(i)] = repair.mesh.vertices();
    repair.mesh.vertex.push_back(mesh.vertex[slot(i)]);
  }
  repair.droppedVertices = mesh.vertices() - repair.mesh.vertices() - repair.weldedVertices;
  for (Index3& v : repair.mesh.triangle) {
    for (int k = 0; k < 3; ++k) v[k] = number[slot(v[k])];
  }

  repair.flippedTriangles = makeConsistent(repair.mesh);
  const std::vector<Component> parts = components(repair.mesh);
  for (std::size_t c = 0; c < parts.size(); ++c) {
    if (!parts[c].clean || parts[c].volume == 0.0) continue;
    const bool cavity = depth(repair.mesh, parts, c) % 2 == 1;
    if ((parts[c].volume < 0.0) == cavity) continue;
    for (const int t : parts[c].triangle) std::swap(repair.mesh.triangle[slot(t)][1], repair.mesh.triangle[slot(t)][2]);
    repair.flippedTriangles += static_cast<int>(parts[c].triangle.size());
  }
  return repair;
}

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

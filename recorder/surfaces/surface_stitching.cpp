// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/surfaces/surface_stitching.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "sim/geometry/closest_point.h"

namespace calot::recorder {
namespace {

struct EdgeCounts {
  int open = 0, shared = 0, flipped = 0;
};

EdgeCounts countEdges(const TriangleMesh& mesh) {
  EdgeCounts counts;
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    counts.open += sides.size() == 1 ? 1 : 0;
    counts.shared += sides.size() > 2 ? 1 : 0;
    counts.flipped += sides.size() == 2 && sides[0].forward == sides[1].forward ? 1 : 0;
  });
  return counts;
}

/// Candidates at most `tolerance` apart become the first of them. @return how many became another
int merge(TriangleMesh& mesh, const std::vector<char>& candidate, double tolerance) {
  using Cell = std::array<std::int64_t, 3>;
  const auto hash = [](const Cell& c) {
    std::uint64_t h = 0;
    for (const std::int64_t x : c) h = (h ^ static_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(h ^ (h >> 32U));
  };
  std::unordered_map<Cell, std::vector<int>, decltype(hash)> grid(64, hash);
  std::vector<int> first(mesh.vertex.size());
  const double size = std::max(tolerance, 1e-12);
  const int reach = tolerance > 0.0 ? 1 : 0;
  int merged = 0;
  for (int v = 0; v < mesh.vertices(); ++v) {
    first[slot(v)] = v;
    if (candidate[slot(v)] == 0) continue;
    const Vec3& p = mesh.vertex[slot(v)];
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[static_cast<int>(k)] / size));
    for (int i = 0; i < 27 && first[slot(v)] == v; ++i) {
      const Cell near{cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1};
      if (reach == 0 && near != cell) continue;
      const auto there = grid.find(near);
      if (there == grid.end()) continue;
      for (const int other : there->second) {
        if (first[slot(v)] == v && (mesh.vertex[slot(other)] - p).norm() <= tolerance) first[slot(v)] = other;
      }
    }
    if (first[slot(v)] == v) {
      grid[cell].push_back(v);
    } else {
      ++merged;
    }
  }
  for (Index3& t : mesh.triangle) {
    for (int& v : t) v = first[slot(v)];
  }
  return merged;
}

/// Patch of each triangle: connected across edges of exactly two triangles.
std::vector<int> patchesOf(const TriangleMesh& mesh, int& count) {
  const std::vector<Index3> neighbour = triangleNeighbours(mesh);
  std::vector<int> patch(mesh.triangle.size(), -1), waiting;
  count = 0;
  for (int seed = 0; seed < mesh.triangles(); ++seed) {
    if (patch[slot(seed)] >= 0) continue;
    patch[slot(seed)] = count;
    waiting.assign(1, seed);
    while (!waiting.empty()) {
      const int t = waiting.back();
      waiting.pop_back();
      for (const int other : neighbour[slot(t)]) {
        if (other < 0 || patch[slot(other)] >= 0) continue;
        patch[slot(other)] = count;
        waiting.push_back(other);
      }
    }
    ++count;
  }
  return patch;
}

/// Can infinity be seen from the middle of a triangle, along one of directions that no mesh has?
bool seesOut(const TriangleMesh& mesh, int from, double far) {
  const Vec3 middle = (mesh.corner(from, 0) + mesh.corner(from, 1) + mesh.corner(from, 2)) / 3.0;
  for (int i = 0; i < 27; ++i) {
    if (i == 13) continue;
    const int row = i / 3 % 3, layer = i / 9;
    const Vec3 direction = Vec3(i % 3 - 0.9731, row - 1.0177, layer - 0.9583).normalized();
    const Vec3 start = middle + 1e-7 * far * direction;
    bool free = true;
    for (int t = 0; t < mesh.triangles() && free; ++t) {
      free = t == from || !closestSegmentTriangle(start, middle + far * direction, mesh.corner(t, 0), mesh.corner(t, 1),
                                                  mesh.corner(t, 2))
                               .crosses;
    }
    if (free) return true;
  }
  return false;
}

constexpr int mostPatches = 200;    ///< with more, no walls are looked for
constexpr int triangleSamples = 8;  ///< of a patch

/// Drops patches from which nothing is seen of the outside. @return how many
int dropWalls(TriangleMesh& mesh) {
  int count = 0;
  const std::vector<int> patch = patchesOf(mesh, count);
  if (count > mostPatches) return 0;
  std::vector<std::vector<int>> triangles(slot(count));
  for (int t = 0; t < mesh.triangles(); ++t) triangles[slot(patch[slot(t)])].push_back(t);
  std::vector<char> wall(slot(count), 0);
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    for (const TriangleSide& side : sides) {
      if (sides.size() > 2) wall[slot(patch[slot(side.triangle)])] = 1;
    }
  });
  const Box box = bounds(mesh);
  const double far = 2.0 * (box.upper - box.lower).norm();
  TriangleMesh kept = mesh;
  kept.triangle.clear();
  int walls = 0;
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    const std::size_t step = triangles[p].size() / triangleSamples + 1;
    for (std::size_t i = 0; i < triangles[p].size() && wall[p] != 0; i += step)
      wall[p] = seesOut(mesh, triangles[p][i], far) ? 0 : 1;
    walls += wall[p];
  }
  for (int t = 0; t < mesh.triangles(); ++t) {
    if (wall[slot(patch[slot(t)])] == 0) kept.triangle.push_back(mesh.triangle[slot(t)]);
  }
  mesh = std::move(kept);
  return walls;
}

/// Gives each patch vertices of its own.
void splitPatches(TriangleMesh& mesh) {
  int count = 0;
  const std::vector<int> patch = patchesOf(mesh, count);
  std::map<std::pair<int, int>, int> number;  // of a vertex in a patch
  TriangleMesh apart;
  for (int t = 0; t < mesh.triangles(); ++t) {
    Index3 triangle = mesh.triangle[slot(t)];
    for (int& v : triangle) {
      const auto [at, isNew] = number.try_emplace({v, patch[slot(t)]}, apart.vertices());
      if (isNew) apart.vertex.push_back(mesh.vertex[slot(v)]);
      v = at->second;
    }
    apart.triangle.push_back(triangle);
  }
  mesh = std::move(apart);
}

}  // namespace

bool hasSoundEdges(const TriangleMesh& mesh) {
  const EdgeCounts counts = countEdges(mesh);
  return counts.open + counts.shared + counts.flipped == 0;
}

int weldVertices(TriangleMesh& mesh) { return merge(mesh, std::vector<char>(mesh.vertex.size(), 1), 0.0); }

void stitchEdges(TriangleMesh& mesh, std::vector<std::string>& notes) {
  const EdgeCounts before = countEdges(mesh);
  if (before.open == 0) return;
  std::vector<char> onOpenEdge(mesh.vertex.size(), 0);
  forEachEdge(mesh, [&](std::span<const TriangleSide> sides) {
    if (sides.size() == 1) onOpenEdge[slot(sides[0].low)] = onOpenEdge[slot(sides[0].high)] = 1;
  });
  const Box box = bounds(mesh);
  EdgeCounts best = before;
  TriangleMesh bestMesh;
  std::string note;
  for (const double share : {1e-7, 1e-6, 1e-5, 1e-4}) {
    const double tolerance = share * (box.upper - box.lower).norm();
    TriangleMesh tried = mesh;
    const int merged = merge(tried, onOpenEdge, tolerance);
    std::erase_if(tried.triangle, [](const Index3& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    const EdgeCounts now = countEdges(tried);
    if (now.shared > before.shared || now.open >= best.open) continue;
    best = now;
    note = fmt::format("{} corners on open edges that were equal within {:.2g} mm were joined: {} open edges became {}",
                       merged, 1000.0 * tolerance, before.open, now.open);
    if (const std::size_t lost = mesh.triangle.size() - tried.triangle.size(); lost > 0)
      note += fmt::format(", {} triangles smaller than that were dropped", lost);
    bestMesh = std::move(tried);
    if (now.open == 0) break;
  }
  if (note.empty()) return;
  mesh = std::move(bestMesh);
  notes.push_back(std::move(note));
}

bool separateParts(TriangleMesh& mesh, std::vector<std::string>& notes) {
  EdgeCounts now = countEdges(mesh);
  if (now.shared == 0) return false;
  const auto taken = [&](TriangleMesh tried) {
    const EdgeCounts then = countEdges(tried);
    if (then.shared >= now.shared || then.open > now.open) return false;
    now = then;
    mesh = std::move(tried);
    return true;
  };
  bool changed = false;
  TriangleMesh tried = mesh;
  if (const int walls = dropWalls(tried); walls > 0 && taken(std::move(tried))) {
    changed = true;
    notes.push_back(fmt::format("{} walls inside the body, which other faces enclose, were left out", walls));
  }
  if (now.shared == 0) return changed;
  tried = mesh;
  splitPatches(tried);
  const int shared = now.shared;
  if (!taken(std::move(tried))) return changed;
  notes.push_back(fmt::format("parts that touch along {} edges were separated there", shared - now.shared));
  return true;
}

}  // namespace calot::recorder

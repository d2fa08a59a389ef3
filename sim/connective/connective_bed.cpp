// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/connective/connective_bed.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/geometry/embedding.h"

namespace calot {

namespace {

/// A vertex of the subdivided bed: up to three surface vertices and the number of n-ths of each; unused entries are -1.
using Blend = std::array<std::array<int, 2>, 3>;

Blend blendOf(const Index3& triangle, const std::array<int, 3>& parts) {
  Blend blend{{{-1, 0}, {-1, 0}, {-1, 0}}};
  for (int c = 0; c < 3; ++c) {
    if (parts[static_cast<std::size_t>(c)] > 0) {
      blend[static_cast<std::size_t>(c)] = {triangle[c], parts[static_cast<std::size_t>(c)]};
    }
  }
  if (blend[1] < blend[0]) std::swap(blend[0], blend[1]);
  if (blend[2] < blend[1]) std::swap(blend[1], blend[2]);
  if (blend[1] < blend[0]) std::swap(blend[0], blend[1]);
  return blend;
}

/// The triangles of a bed with every edge divided by n; vertices are numbered in order of first use.
struct Division {
  std::vector<Blend> vertex;
  std::vector<Index3> triangle;
};

Division divide(const std::vector<Index3>& bed, int n) {
  Division out;
  std::map<Blend, int> number;
  const auto at = [&](const Index3& t, int i, int j) {
    const Blend blend = blendOf(t, {n - i - j, i, j});
    const auto [found, isNew] = number.try_emplace(blend, static_cast<int>(out.vertex.size()));
    if (isNew) out.vertex.push_back(blend);
    return found->second;
  };
  for (const Index3& t : bed) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        // Vertices are numbered on first use: one statement each, since the order of evaluation
        // of arguments is unspecified.
        const int third = at(t, i, j + 1);
        const int second = at(t, i + 1, j);
        const int first = at(t, i, j);
        out.triangle.emplace_back(first, second, third);
        if (i + j + 1 < n) {
          const int opposite = at(t, i + 1, j + 1);
          out.triangle.emplace_back(second, opposite, third);
        }
      }
    }
  }
  return out;
}

/// Index of each element by its corners.
using ElementIndex = std::map<std::array<int, 4>, int>;

ElementIndex elementsOf(const TetrahedralMesh& mesh) {
  ElementIndex out;
  for (std::size_t e = 0; e < mesh.tetrahedron.size(); ++e) {
    const Index4& t = mesh.tetrahedron[e];
    out.emplace(std::array{t[0], t[1], t[2], t[3]}, static_cast<int>(e));
  }
  return out;
}

MaterialPoint pointOf(const Embedding::Anchor& anchor, const ElementIndex& elements) {
  MaterialPoint point;
  point.element = elements.at(anchor.node);
  point.count = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    point.node[k] = anchor.node[k];
    point.weight[k] = anchor.weight[k];
  }
  return point;
}

std::vector<std::array<std::uint32_t, 2>> edgesOf(const std::vector<Index3>& triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const Index3& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(t[k]);
      const auto b = static_cast<std::uint32_t>(t[(k + 1) % 3]);
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

std::vector<Index3> bedTriangles(const TriangleMesh& first, const SurfaceDistance& second, double reach) {
  std::vector<bool> near;
  for (const Vec3& p : first.vertex) near.push_back(second.signedDistance(p) <= reach);
  std::vector<Index3> bed;
  for (const Index3& t : first.triangle) {
    if (near[slot(t[0])] && near[slot(t[1])] && near[slot(t[2])]) bed.push_back(t);
  }
  return bed;
}

ConnectiveBed makeBed(const BedOrgan& first, const BedOrgan& second, double reach, std::size_t minStrands) {
  ConnectiveBed out;
  const SurfaceDistance distance(second.surface);
  const std::vector<Index3> bed = bedTriangles(first.surface, distance, reach);
  if (bed.empty()) {
    out.error = "no triangle of the first organ lies within " + std::to_string(1000.0 * reach) +
                " mm of the second: there is no bed for connective tissue";
    return out;
  }
  int n = 1;
  Division division = divide(bed, n);
  while (division.vertex.size() < minStrands) division = divide(bed, ++n);

  std::vector<Vec3> ends;
  std::vector<Vec3> feet;
  for (const Blend& blend : division.vertex) {
    Vec3 p = Vec3::Zero();
    for (const auto& [vertex, parts] : blend) {
      if (vertex >= 0) p += static_cast<double>(parts) / n * first.surface.vertex[slot(vertex)];
    }
    ends.push_back(p);
    feet.push_back(distance.closest(p).on.point);
  }
  const ElementIndex elementsOfFirst = elementsOf(first.mesh);
  const ElementIndex elementsOfSecond = elementsOf(second.mesh);
  const Embedding inFirst(ends, first.mesh);
  const Embedding inSecond(feet, second.mesh);
  for (std::size_t s = 0; s < ends.size(); ++s) {
    Strand strand;
    strand.a = pointOf(inFirst.anchors()[s], elementsOfFirst);
    strand.b = pointOf(inSecond.anchors()[s], elementsOfSecond);
    const Vec3 way = ends[s] - feet[s];
    strand.restLength = way.norm();
    // Where organs touch or overlap at rest, strands still point out of the second one.
    const Index3& t = second.surface.triangle[slot(distance.closest(ends[s]).triangle)];
    const Vec3& a = second.surface.vertex[slot(t[0])];
    const Vec3 outward = (second.surface.vertex[slot(t[1])] - a).cross(second.surface.vertex[slot(t[2])] - a);
    strand.restDirection = strand.restLength > 1e-5 ? Vec3(way / strand.restLength) : Vec3(outward / outward.norm());
    out.strands.push_back(strand);
  }
  for (const Index3& t : division.triangle) {
    const Vec3& a = ends[slot(t[0])];
    const double third = (ends[slot(t[1])] - a).cross(ends[slot(t[2])] - a).norm() / 6.0;
    for (int k = 0; k < 3; ++k) out.strands[slot(t[k])].area += third;
  }
  out.sheets = edgesOf(division.triangle);
  return out;
}

}  // namespace calot

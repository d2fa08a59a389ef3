// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces and their measures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

/// Short cast from int indices to std::size_t. @pre i >= 0
constexpr std::size_t slot(int i) { return static_cast<std::size_t>(i); }

/// A triangle surface. An outward triangle is counter-clockwise seen from outside: (b - a) x (c - a) points out.
/// @pre of every function here: indices are in range (the readers of recorder/formats refuse anything else).
struct TriangleMesh {
  std::vector<Vec3> vertex;      ///< m
  std::vector<Index3> triangle;  ///< three indices into `vertex`

  /// Position of corner k (0, 1, 2) of triangle t.
  [[nodiscard]] const Vec3& corner(int t, int k) const { return vertex[slot(triangle[slot(t)][k])]; }
  [[nodiscard]] int triangles() const { return static_cast<int>(triangle.size()); }
  [[nodiscard]] int vertices() const { return static_cast<int>(vertex.size()); }
};

/// Sum of the triangles' areas (m^2).
[[nodiscard]] double surfaceArea(const TriangleMesh& mesh);

/// Enclosed volume by the divergence theorem, positive when outward (m^3): V = 1/6 sum (a - o) . ((b - o) x (c - o)), o
/// the centre of the bounds (less cancellation than the origin).
[[nodiscard]] double signedVolume(const TriangleMesh& mesh);

/// Bounds of all vertices (m); an empty box without any.
[[nodiscard]] Box bounds(const TriangleMesh& mesh);

/// One side of one triangle: edge k joins corner k and corner (k + 1) mod 3.
struct TriangleSide {
  int low = 0;   ///< the edge's smaller vertex index
  int high = 0;  ///< the larger
  int triangle = 0;
  int side = 0;          ///< k
  bool forward = false;  ///< the triangle runs from low to high
};

/// All sides, ordered by (low, high, triangle, side): sides of one edge are adjacent.
[[nodiscard]] std::vector<TriangleSide> sortedSides(const TriangleMesh& mesh);

/// Calls visit(sides) for each edge, in the order of sortedSides().
template <class Visit>
void forEachEdge(const TriangleMesh& mesh, Visit&& visit) {
  const std::vector<TriangleSide> sides = sortedSides(mesh);
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
    visit(std::span(sides).subspan(i, end - i));
  }
}

/// neighbour[t][k]: the triangle across side k of t; -1 if the edge does not have exactly two sides.
[[nodiscard]] std::vector<Index3> triangleNeighbours(const TriangleMesh& mesh);

/// Component of each triangle (connected across edges, manifold or not), numbered from 0 in order of each component's
/// first triangle. @param[out] count number of components
[[nodiscard]] std::vector<int> triangleComponents(const TriangleMesh& mesh, int& count);

/// The smallest n such that no side of a cell is longer than `longest` (m), at most `most`.
inline std::uint32_t cellsAlongSide(const Vec3& a, const Vec3& b, const Vec3& c, double longest, std::uint32_t most) {
  const double side2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  std::uint32_t n = 1;
  while (n < most && longest * longest * (n * n) < side2) ++n;
  return n;
}

/// Calls visit(cell, weights) for each of the n^2 cells in order: barycentric weights of its centroid, of the corners.
template <class Visit>
void forEachTriangleCell(std::uint32_t n, Visit&& visit) {
  const double size = 1.0 / n;
  std::uint32_t cell = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; i + j < n; ++j) {
      const auto at = [&](double third) {
        const double u = (i + third) * size;
        const double v = (j + third) * size;
        visit(cell++, Vec3(1.0 - (u + v), u, v));
      };
      at(1.0 / 3.0);
      if (i + j + 1 < n) at(2.0 / 3.0);
    }
  }
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces and their measures.
#pragma once

#include <cstddef>
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

/// neighbour[t][k]: the triangle across side k of t; -1 if the edge does not have exactly two sides.
[[nodiscard]] std::vector<Index3> triangleNeighbours(const TriangleMesh& mesh);

/// Component of each triangle (connected across edges, manifold or not), numbered from 0 in order of each component's
/// first triangle. @param[out] count number of components
[[nodiscard]] std::vector<int> triangleComponents(const TriangleMesh& mesh, int& count);

}  // namespace calot

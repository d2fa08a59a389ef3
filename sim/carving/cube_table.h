// SPDX-License-Identifier: GPL-3.0-or-later
// Triangulation of the surface within a lattice cell.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sim/carving/carved_field.h"

namespace calot {

/// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge e = 4 a + u + 2 v runs along axis a from the corner
/// with coordinates u, v along axes a + 1 and a + 2 (mod 3). Face f = 2 a + s is normal to axis a, at coordinate s.
struct CubeCase {
  static constexpr std::size_t maxTriangles = 5;  ///< triangles of a cell

  std::uint8_t count = 0;
  std::array<std::array<std::uint8_t, 3>, maxTriangles> edge{};  ///< edges on which a triangle's corners lie; outward
  /// Side k of triangle t, from corner k to k + 1: the triangle of this cell across it, or -1 - f if the side lies on
  /// face f and the triangle across belongs to the next cell.
  std::array<std::array<std::int16_t, 3>, maxTriangles> across{};
};

/// Marching cubes (Lorensen and Cline 1987) with loops traced over the faces of the cell instead of a published table.
/// On each face a cut surrounds each run of inside corners, so that inside corners across a face's diagonal are
/// separated in both of its cells. The inside is thus connected along lattice edges only. A loop is filled with
/// triangles of which no inner side lies on a face of the cell, so that two cells never share one. Every side therefore
/// has exactly two triangles for all signs, and every vertex one fan.
class CubeTable {
 public:
  /// Bit c of `inside`: corner c is inside.
  [[nodiscard]] const CubeCase& operator[](unsigned inside) const { return case_[inside]; }

  /// The one table, made at first use.
  static const CubeTable& get();

 private:
  CubeTable();
  std::array<CubeCase, 256> case_{};
};

/// The two faces that an edge of the cell lies on, as bits.
[[nodiscard]] constexpr unsigned facesOfEdge(unsigned edge) {
  const unsigned a = edge / 4;
  const unsigned u = edge & 1U;
  const unsigned v = edge >> 1U & 1U;
  return 1U << (2 * ((a + 1) % 3) + u) | 1U << (2 * ((a + 2) % 3) + v);
}

/// The same edge of face f as numbered in the cell on its other side. @pre the edge lies on f
[[nodiscard]] constexpr unsigned edgeFromBeyond(unsigned edge, unsigned face) {
  const unsigned a = edge / 4;
  return edge ^ (face / 2 == (a + 1) % 3 ? 1U : 2U);
}

// Adjacency on the surface of a carved field, computed from the signs alone: nothing is stored or can be stale.

/// Triangles are named as in SurfacePatch: 8 * cell + number in the cell; vertices are lattice edges (surface_vertex).
class SurfaceAdjacency {
 public:
  /// Maximum number of triangles around one vertex: four cells, in each of which its loop has at most five.
  static constexpr std::size_t maxAround = 4 * CubeCase::maxTriangles;

  /// @param field must outlive this
  explicit SurfaceAdjacency(const CarvedField& field) : field_(field), table_(CubeTable::get()) {}

  /// True if this triangle exists now.
  [[nodiscard]] bool exists(std::uint32_t triangle) const;
  /// Its three vertices, outward. @pre exists(triangle)
  [[nodiscard]] std::array<std::uint32_t, 3> vertices(std::uint32_t triangle) const;
  /// The triangle across side k (from corner k to k + 1), which always exists. @pre exists(triangle)
  [[nodiscard]] std::uint32_t across(std::uint32_t triangle, std::size_t k) const;
  /// Triangles around a vertex, a closed fan, in the order of cells around its edge.
  /// @param out at least maxAround long @return their number; 0 if the edge is not cut
  std::size_t around(std::uint32_t vertex, std::span<std::uint32_t> out) const;

 private:
  [[nodiscard]] unsigned caseOf(std::uint32_t cell) const;
  [[nodiscard]] std::uint32_t vertexOf(std::uint32_t cell, unsigned edge) const;

  const CarvedField& field_;
  const CubeTable& table_;
};

}  // namespace calot

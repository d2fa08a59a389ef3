// SPDX-License-Identifier: GPL-3.0-or-later
// Triangulation of the surface within a lattice cell.
#pragma once

#include <array>
#include <cstdint>

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

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Adjacency on the surface of a carved field, computed from the signs alone: nothing is stored or can be stale.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sim/carving/carved_field.h"
#include "sim/carving/cube_table.h"

namespace calot {

/// Triangles are named as in SurfacePatch: 8 * cell + number in the cell; vertices are lattice edges (surface_vertex).
class SurfaceAdjacency {
 public:
  /// Maximum number of triangles around one vertex: four cells, in each of which its loop has at most five.
  static constexpr std::size_t maxAround = 4 * CubeCase::maxTriangles;

  /// @param field must outlive this
  explicit SurfaceAdjacency(const CarvedField& field) : field_(field), table_(CubeTable::get()) {}

  /// Does this triangle exist now?
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

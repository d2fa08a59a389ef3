// SPDX-License-Identifier: GPL-3.0-or-later
// Fill of each coarse hexahedron of a carved body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_field.h"

namespace calot {

/// Coarse hexahedra of k^3 lattice cells: hexahedron h spans cells k h to k h + k - 1 along each axis. Each node
/// belongs to exactly one, along each axis to number min(n / k, last): the last of k + 1 nodes belongs to the
/// neighbour, except in the last hexahedron. The fill is the integer count of inside nodes, a function of the field
/// alone; k^3 is full.
///
/// Derived from the field; never saved. Allocates only in its constructor.
class Fill {
 public:
  /// @pre k >= 1 divides nodes() - 1 along each axis
  Fill(const BrickLattice& lattice, int k);

  [[nodiscard]] int cells() const { return k_; }
  /// Hexahedra along each axis.
  [[nodiscard]] const Index3& size() const { return size_; }
  /// Number of a hexahedron, x fastest.
  [[nodiscard]] std::uint32_t hexahedron(const Index3& h) const {
    return static_cast<std::uint32_t>(h[0] + size_[0] * (h[1] + size_[1] * h[2]));
  }
  [[nodiscard]] Index3 hexahedronOfNode(const Index3& node) const { return (node.array() / k_).min(size_.array() - 1); }
  /// Nodes that belong to a hexahedron: lower <= n < upper.
  [[nodiscard]] Index3 lower(const Index3& h) const { return k_ * h; }
  [[nodiscard]] Index3 upper(const Index3& h) const {
    return k_ * (h.array() + 1) + (h.array() == size_.array() - 1).cast<int>();
  }

  void rebuild(const CarvedField& field);
  /// Updates what the last stroke changed. @pre as CarvedSurface::update()
  void update(const CarvedField& field);

  /// Inside nodes of each hexahedron.
  [[nodiscard]] std::span<const std::int32_t> counts() const { return count_; }
  /// Hexahedra whose count the last update() or rebuild() changed, ascending.
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }

 private:
  BrickLattice lattice_;
  int k_;
  Index3 size_;
  std::vector<std::int32_t> count_;
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> changed_;
};

}  // namespace calot

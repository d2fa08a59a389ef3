// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of a solid: triangles with their neighbourhood, gathered into patches, the leaves of the broad
// phase.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

/// Fixed topology of a closed surface over the nodes of a solid.
class ContactSurface {
 public:
  struct Patch {
    std::size_t first = 0;  ///< triangles [first, last)
    std::size_t last = 0;
  };

  static constexpr std::size_t largestPatch = 48;

  /// Orders the triangles into patches of neighbours (by recursive halving of their rest centroids along the longest
  /// side, ties by index), at most `largestPatch` each.
  /// @param triangles outward, closed manifold
  ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles);

  [[nodiscard]] const std::vector<Index3>& triangles() const { return triangle_; }
  [[nodiscard]] const std::vector<Patch>& patches() const { return patch_; }
  /// Node opposite to edge k (corners k and k + 1) in the neighbouring triangle.
  [[nodiscard]] int opposite(std::size_t triangle, int k) const { return opposite_[triangle][k]; }
  /// Nodes that share a surface edge with this node, ascending.
  [[nodiscard]] std::span<const int> neighbours(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {neighbour_.data() + neighbourStart_[n], neighbour_.data() + neighbourStart_[n + 1]};
  }
  /// Surface nodes, ascending.
  [[nodiscard]] const std::vector<int>& nodes() const { return node_; }

 private:
  std::vector<Index3> triangle_;
  std::vector<Patch> patch_;
  std::vector<Index3> opposite_;
  std::vector<std::size_t> neighbourStart_;
  std::vector<int> neighbour_;
  std::vector<int> node_;
};

/// Bounds of each patch, rounded outward by one unit in the last place of float and `margin`.
void patchBounds(const ContactSurface& surface, std::span<const Vec3> position, double margin, std::vector<Box>& out);

}  // namespace calot

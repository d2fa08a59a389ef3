// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of a solid: triangles with their neighbourhood, gathered into patches, the leaves of the broad
// phase.
#pragma once

#include <cstddef>
#include <cstdint>
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

  static constexpr std::size_t largestPatch = 64;

  /// Orders the triangles into patches of neighbours (by recursive halving of their rest centroids along the longest
  /// side, ties by index), at most `largestPatch` each, so that
  /// patches of a larger surface hold 32 to 64.
  /// @param triangles outward, closed manifold
  ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles);

  [[nodiscard]] const std::vector<Index3>& triangles() const { return triangle_; }
  [[nodiscard]] const std::vector<Patch>& patches() const { return patch_; }
  /// Node opposite to edge k (corners k and k + 1) in the neighbouring triangle.
  [[nodiscard]] int opposite(std::size_t triangle, int k) const { return opposite_[triangle][k]; }
  /// The triangle on the other side of edge k, -1 at a border.
  [[nodiscard]] int neighbourTriangle(std::size_t triangle, int k) const { return beyond_[triangle][k]; }
  /// Triangles that have this node as a corner, ascending.
  [[nodiscard]] std::span<const std::uint32_t> trianglesAround(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {around_.data() + aroundStart_[n], around_.data() + aroundStart_[n + 1]};
  }
  /// The patch that a triangle lies in.
  [[nodiscard]] std::uint32_t patchOf(std::size_t triangle) const { return patchOf_[triangle]; }
  /// Nodes that belong to a patch, ascending: each surface node to the first patch that has it as a corner.
  [[nodiscard]] std::span<const int> patchNodes(std::uint32_t patch) const {
    return {patchNode_.data() + patchNodeStart_[patch], patchNode_.data() + patchNodeStart_[patch + 1]};
  }
  /// Corners of a patch's triangles, ascending, each once.
  [[nodiscard]] std::span<const int> patchCorners(std::uint32_t patch) const {
    return {patchCorner_.data() + patchCornerStart_[patch], patchCorner_.data() + patchCornerStart_[patch + 1]};
  }
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
  std::vector<Index3> beyond_;
  std::vector<std::size_t> aroundStart_;
  std::vector<std::uint32_t> around_;
  std::vector<std::uint32_t> patchOf_;
  std::vector<std::size_t> patchNodeStart_;
  std::vector<int> patchNode_;
  std::vector<std::size_t> patchCornerStart_;
  std::vector<int> patchCorner_;
  std::vector<std::size_t> neighbourStart_;
  std::vector<int> neighbour_;
  std::vector<int> node_;
};

/// Bounds of each patch, grown by `margin` and rounded outward to float (docs/contact.md).
void patchBounds(const ContactSurface& surface, std::span<const Vec3> position, double margin, std::vector<Box>& out);

/// Names the patches whose bounds changed, ascending, for BroadPhase::refit(). @pre sizes agree
void changedBounds(std::span<const Box> before, std::span<const Box> after, std::vector<std::uint32_t>& changed);

}  // namespace calot

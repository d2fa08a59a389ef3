// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of a solid: triangles with their neighbourhood, gathered into patches, the leaves of the broad
// phase.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

/// Neighbourhood on a closed surface whose triangles come and go, worked out when asked for.
class SurfaceTopology {
 public:
  static constexpr std::size_t mostAround = 20;  ///< triangles at a node

  virtual ~SurfaceTopology() = default;
  /// The triangle on the other side of edge k.
  [[nodiscard]] virtual std::size_t across(std::size_t triangle, int k) const = 0;
  /// Triangles that have this node as a corner, in an order fixed by the surface. @return how many
  virtual std::size_t around(int node, std::span<std::uint32_t, mostAround> out) const = 0;
};

/// Topology of a closed surface over the nodes of a solid: fixed (an organ's), or one that changes (what is left of
/// fat). Contact code sees no difference but in names: the contacts of a surface that changes are named so that those
/// stay the same that a change elsewhere leaves alone.
class ContactSurface {
 public:
  struct Patch {
    std::size_t first = 0;  ///< triangles [first, last)
    std::size_t last = 0;
  };

  /// Room for what is worked out when asked for.
  struct Fan {
    std::array<std::uint32_t, SurfaceTopology::mostAround> triangle;
    std::array<int, 3 * SurfaceTopology::mostAround> node;
  };

  static constexpr std::size_t largestPatch = 64;

  /// Orders the triangles into patches of neighbours (by recursive halving of their rest centroids along the longest
  /// side, ties by index), at most `largestPatch` each, so that
  /// patches of a larger surface hold 32 to 64.
  /// @param triangles outward, closed manifold
  ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles);

  /// A surface that changes; without a triangle until setPatches(). patchNodes(), patchOf(), nodes() and the calls
  /// without a Fan are not for it, nor is SurfacePair.
  /// @param topology outlives this
  /// @param room triangles have numbers below this; at most 2^30. Nodes have numbers below 2^25
  ContactSurface(const SurfaceTopology& topology, std::size_t room)
      : topology_(&topology), triangle_(room, Index3::Zero()), name_(room, 0) {}

  /// Which triangles there are, by patches; swaps the lists with those given. Numbers in the patches are ascending.
  /// @param cornerStart per patch and the end: where its corners start in `corner` (patchCorners())
  void setPatches(std::vector<Patch>& patches, std::vector<std::size_t>& cornerStart, std::vector<int>& corner) {
    patch_.swap(patches);
    patchCornerStart_.swap(cornerStart);
    patchCorner_.swap(corner);
  }
  /// @param name below 2^30, of its own among the triangles there are
  void setTriangle(std::size_t triangle, const Index3& corners, std::uint32_t name) {
    triangle_[triangle] = corners;
    name_[triangle] = name;
  }

  /// Does it change?
  [[nodiscard]] bool changes() const { return topology_ != nullptr; }
  /// What a triangle is called in keys of contacts: its number, where the surface is fixed.
  [[nodiscard]] std::uint64_t name(std::size_t triangle) const {
    return topology_ == nullptr ? triangle : name_[triangle];
  }

  /// By number; of a surface that changes, only those of the patches mean something.
  [[nodiscard]] const std::vector<Index3>& triangles() const { return triangle_; }
  [[nodiscard]] const std::vector<Patch>& patches() const { return patch_; }
  /// Node opposite to edge k (corners k and k + 1) in the neighbouring triangle.
  [[nodiscard]] int opposite(std::size_t triangle, int k) const {
    return topology_ == nullptr ? opposite_[triangle][k] : oppositeNow(triangle, k);
  }
  /// The triangle on the other side of edge k, -1 at a border.
  [[nodiscard]] int neighbourTriangle(std::size_t triangle, int k) const {
    return topology_ == nullptr ? beyond_[triangle][k] : static_cast<int>(topology_->across(triangle, k));
  }
  /// Triangles that have this node as a corner, ascending.
  [[nodiscard]] std::span<const std::uint32_t> trianglesAround(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {around_.data() + aroundStart_[n], around_.data() + aroundStart_[n + 1]};
  }
  /// The same for every surface; in the order of SurfaceTopology where it changes.
  [[nodiscard]] std::span<const std::uint32_t> trianglesAround(int node, Fan& fan) const {
    if (topology_ == nullptr) return trianglesAround(node);
    return {fan.triangle.data(), topology_->around(node, fan.triangle)};
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
  /// The same for every surface; where it changes in no special order, and more than once.
  [[nodiscard]] std::span<const int> neighbours(int node, Fan& fan) const;
  /// Surface nodes, ascending.
  [[nodiscard]] const std::vector<int>& nodes() const { return node_; }

 private:
  [[nodiscard]] int oppositeNow(std::size_t triangle, int k) const;

  const SurfaceTopology* topology_ = nullptr;
  std::vector<Index3> triangle_;
  std::vector<std::uint32_t> name_;  ///< of a surface that changes
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

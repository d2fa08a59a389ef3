// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of what is left of fat, as contact takes it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_surface.h"
#include "sim/carving/surface_adjacency.h"
#include "sim/contact/surface_patches.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// A node of fat's skin: in edges from its cube's corner, a little beyond the cube at most.
struct SkinNode {
  double x, y, z;
  std::uint32_t number;
  std::int32_t cube;
};

/// Follows a CarvedSurface as a ContactSurface. Every number that contact sees is a function of the field alone, so
/// that order, ties and keys are those of a rebuilt one:
/// - node 192 rank + 64 axis + x + 4 y + 16 z is a lattice edge: rank of its block (FatModel), place of its lower end
/// in
///   the block. A vertex keeps its number as long as it is there.
/// - triangle 320 rank + k is the k-th of a block (four cells along each axis hold at most 320). In keys, triangles go
///   by their names (SurfacePatch), which a stroke in the same block changes only where it changes their cell.
/// - patches are those of the CarvedSurface, in order of their keys.
///
/// A stroke's cost goes with the blocks that it changed, but for the list of patches (some 10 ns a patch).
class CarvedContact final : public SurfaceTopology {
 public:
  /// A trilinear map of one cube: of 1, x, y, z, xy, xz, yz, xyz, each three components and one to fill up.
  using CubeMap = std::array<double, 32>;

  static constexpr std::uint32_t nodesOfBlock = 192;
  static constexpr std::uint32_t trianglesOfBlock = 320;

  /// @param model, field outlive this
  CarvedContact(const FatModel& model, const CarvedField& field);
  CarvedContact(const CarvedContact&) = delete;
  CarvedContact& operator=(const CarvedContact&) = delete;

  /// All of it. @pre the surface is that of the field, and the field the model's
  void rebuild(const CarvedSurface& surface);
  /// What the last stroke changed. @pre the surface was updated, and update() or rebuild() ran after every stroke
  void update(const CarvedSurface& surface);

  [[nodiscard]] const ContactSurface& surface() const { return surface_; }
  /// Numbers of nodes are below this.
  [[nodiscard]] std::size_t nodeRoom() const { return cut_.size(); }
  /// Is there such a vertex now?
  [[nodiscard]] bool exists(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return n < cut_.size() && (mask_[n / 64] >> (n % 64) & 1U) != 0;
  }
  /// Where the vertices are (m, W) for these positions of the solid's nodes, by number; places of numbers without a
  /// vertex are left as they are. Allocates at first.
  void place(std::span<const Vec3> solid, std::vector<Vec3>& out) const;
  /// The solid's nodes that a vertex goes with, and their shares.
  [[nodiscard]] SolidPlace anchor(int node) const;
  /// A point of a triangle in terms of the solid's nodes: each corner's cube by the corner's weight, up to 24 nodes.
  /// So the shares add up to one, and their mean place is the point itself, however the cubes are bent: a force there
  /// keeps its sum and its moment, and its power is that of the point.
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const;
  /// How often update() had to make room.
  [[nodiscard]] std::size_t growths() const { return growths_; }

  // SurfaceTopology
  [[nodiscard]] std::size_t across(std::size_t triangle, int k) const override;
  std::size_t around(int node, std::span<std::uint32_t, mostAround> out) const override;

 private:
  [[nodiscard]] int nodeOf(std::uint32_t latticeEdge) const;
  [[nodiscard]] std::uint32_t latticeEdgeOf(int node) const;
  [[nodiscard]] std::uint32_t triangleOf(std::uint32_t name) const;
  [[nodiscard]] Vec3 cellsOf(std::size_t node) const;
  [[nodiscard]] std::uint64_t insideOfBlock(const Index3& block) const;
  void markRaised();
  void mark(const Index3& block);
  void measure(std::uint32_t rank);
  void writeBlock(const CarvedSurface& surface, std::uint32_t rank);
  void listPatches(const CarvedSurface& surface);
  void listNodes() const;

  const FatModel& model_;
  const CarvedField& field_;
  SurfaceAdjacency adjacency_;
  ContactSurface surface_;
  std::vector<Index3> origin_;         ///< first node of each ranked block
  std::vector<std::uint64_t> mask_;    ///< per rank and axis: which edges are cut
  std::vector<double> cut_;            ///< per node: share of the edge
  std::vector<std::int32_t> cube_;     ///< per node: that it goes with
  std::vector<std::uint16_t> count_;   ///< triangles of each ranked block
  std::vector<std::uint32_t> first_;   ///< its first patch
  std::vector<std::uint8_t> written_;  ///< since its corners were listed
  std::vector<std::uint8_t> dirty_;
  std::vector<std::uint32_t> dirtyRank_;
  // The lists that are made next.
  std::vector<ContactSurface::Patch> patch_;
  std::vector<std::size_t> cornerStart_;
  std::vector<int> corner_;
  std::size_t listed_ = 0;  ///< room that the last lists ended with
  // Room of place().
  mutable std::vector<double> padded_;
  mutable std::vector<CubeMap> map_;
  mutable std::vector<double> placed_;
  mutable std::vector<SkinNode> skinNode_;  ///< all, once they are asked for
  mutable bool nodesListed_ = false;        ///< since a stroke changed them
  std::size_t growths_ = 0;
};

}  // namespace calot

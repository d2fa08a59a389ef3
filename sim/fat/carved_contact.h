// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of the remaining fat.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_surface.h"
#include "sim/carving/cube_table.h"
#include "sim/contact/surface_patches.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// A node of the fat's surface: coordinates in its cube in units of its edge, slightly beyond the cube at most.
struct SkinNode {
  double x, y, z;
  std::uint32_t number;
  std::int32_t cube;
};

/// A CarvedSurface as a ContactSurface. All indices are functions of the field alone, so that order, ties and keys
/// equal those of a rebuilt surface:
/// - node 192 rank + 64 axis + x + 4 y + 16 z is a lattice edge: the rank of its block (FatModel) and the position of
///   its lower end in the block. A vertex keeps its index as long as it exists.
/// - triangle 320 rank + k is the k-th of a block (four cells along each axis hold at most 320). Contact keys use
///   triangle names (SurfacePatch), which a stroke in the same block changes only where it changes their cell.
/// - patches are those of the CarvedSurface, in order of their keys.
///
/// The cost of a stroke is proportional to the number of blocks that it changed, plus some 10 ns per patch for
/// the list of patches.
class CarvedContact final : public SurfaceTopology {
 public:
  /// Trilinear map of one cube: coefficients of 1, x, y, z, xy, xz, yz, xyz, each three components and one of padding.
  using CubeMap = std::array<double, 32>;

  static constexpr std::uint32_t nodesOfBlock = 192;
  static constexpr std::uint32_t trianglesOfBlock = 320;

  /// @param model, field outlive this
  CarvedContact(const FatModel& model, const CarvedField& field);
  CarvedContact(const CarvedContact&) = delete;
  CarvedContact& operator=(const CarvedContact&) = delete;

  /// Rebuilds everything. @pre the surface is that of the field, and the field the model's
  void rebuild(const CarvedSurface& surface);
  /// Rebuilds what the last stroke changed. @pre the surface was updated, and update() or rebuild()
  /// ran after every stroke
  void update(const CarvedSurface& surface);

  [[nodiscard]] const ContactSurface& surface() const { return surface_; }
  /// Upper bound of node indices.
  [[nodiscard]] std::size_t nodeCapacity() const { return cut_.size(); }
  /// True if this vertex exists now.
  [[nodiscard]] bool exists(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return n < cut_.size() && (mask_[n / 64] >> (n % 64) & 1U) != 0;
  }
  /// Positions of the vertices (m, W), by index, for these positions of the solid's nodes. Entries without a vertex are
  /// unchanged. Allocates on first use.
  void positions(std::span<const Vec3> solid, std::vector<Vec3>& out) const;
  /// Nodes of the solid that a vertex depends on, and their weights.
  [[nodiscard]] MaterialPoint anchor(int node) const;
  /// A point of a triangle in terms of the solid's nodes: each corner's cube times the corner's weight, up to 24 nodes.
  /// The weights add up to one and reproduce the point for any deformation of the cubes, so that a force there keeps
  /// its resultant, moment and power.
  [[nodiscard]] SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const;
  /// Number of reallocations by update().
  [[nodiscard]] std::size_t growths() const { return growths_; }

  // SurfaceTopology
  [[nodiscard]] std::size_t across(std::size_t triangle, int k) const override;
  std::size_t around(int node, std::span<std::uint32_t, maxAround> out) const override;

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
  std::vector<std::int32_t> cube_;     ///< per node: its cube
  std::vector<std::uint16_t> count_;   ///< triangles of each ranked block
  std::vector<std::uint32_t> first_;   ///< its first patch
  std::vector<std::uint8_t> written_;  ///< rewritten since its corners were listed
  std::vector<std::uint8_t> dirty_;
  std::vector<std::uint32_t> dirtyRank_;
  // The lists being built.
  std::vector<ContactSurface::Patch> patch_;
  std::vector<std::size_t> cornerStart_;
  std::vector<int> corner_;
  std::size_t listed_ = 0;  ///< capacity after the last update
  // Scratch of positions().
  mutable std::vector<double> padded_;
  mutable std::vector<CubeMap> map_;
  mutable std::vector<double> placed_;
  mutable std::vector<SkinNode> skinNode_;  ///< all vertices, computed on demand
  mutable bool nodesListed_ = false;        ///< valid since the last stroke
  std::size_t growths_ = 0;
};

}  // namespace calot

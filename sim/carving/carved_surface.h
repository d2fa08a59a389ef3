// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a carved field for simulation: contact and volumes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/cube_table.h"

namespace calot {

/// A vertex is a lattice edge, 3 * node + axis: the edge from the node along +axis. Its position depends only on the
/// two values at the edge's ends.
namespace surface_vertex {
/// Minimum distance of a cut from the edge's ends, as a share of the edge: prevents slivers for any field.
inline constexpr double minCut = 0.15;

/// Position of the cut on the edge: share from its node, in [minCut, 1 - minCut].
[[nodiscard]] double cut(const CarvedField& field, std::uint32_t vertex);
/// m, in the reference configuration
[[nodiscard]] Vec3 restPosition(const CarvedField& field, std::uint32_t vertex);
}  // namespace surface_vertex

/// Up to 64 triangles of a block, a leaf of the broad phase. A block is 4^3 cells, an eighth of a brick, with
/// index 8 brick + x + 2 y + 4 z. A smooth surface through a block has 32 to 60 triangles, one patch; noise has
/// up to five patches.
struct SurfacePatch {
  static constexpr std::size_t maxTriangles = 64;
  static constexpr std::size_t maxVertices = 3 * maxTriangles;

  std::uint32_t key = 0;  ///< 8 block + index in the block: unique, a function of the field alone
  std::uint8_t triangleCount = 0;
  std::uint8_t vertexCount = 0;
  std::array<std::uint32_t, maxVertices> vertex;                 ///< lattice edges, each once, in order of first use
  std::array<std::array<std::uint8_t, 3>, maxTriangles> corner;  ///< into `vertex`; outward
  std::array<std::uint32_t, maxTriangles> triangle;              ///< names, ascending: 8 * cell + number in the cell

  [[nodiscard]] std::uint32_t vertexOf(std::size_t t, std::size_t k) const { return vertex[corner[t][k]]; }
};

/// Marching cubes over all cells (cube_table.h), updated with the field: after a stroke, only blocks with a sign change
/// at a corner of a cell are rebuilt, and the result equals that of rebuild(), bit for bit. Positions are not stored;
/// they follow from the field (surface_vertex).
///
/// Closed and manifold for every field whose border is outside. rebuild() reserves twice the current number of patches;
/// update() allocates only beyond that, and counts such events.
class CarvedSurface {
 public:
  explicit CarvedSurface(const BrickLattice& lattice);

  /// Rebuilds everything: at the start and after a restore.
  void rebuild(const CarvedField& field);
  /// Rebuilds what the last stroke changed. @pre the field was committed, and update() or rebuild()
  /// ran after every stroke
  void update(const CarvedField& field);

  /// Blocks rebuilt by the last update() or rebuild(), ascending, including empty ones.
  [[nodiscard]] std::span<const std::uint32_t> changedBlocks() const { return changedBlock_; }
  /// Bricks with triangles, ascending.
  [[nodiscard]] std::span<const std::uint32_t> bricks() const { return brick_; }
  [[nodiscard]] std::size_t triangles() const { return triangles_; }
  [[nodiscard]] std::size_t patches() const { return patches_; }
  /// Number of reallocations by update().
  [[nodiscard]] std::size_t growths() const { return growths_; }

  /// Calls visit(patch) for each patch of a block, in order of keys.
  template <class Visit>
  void forEachPatchOfBlock(std::uint32_t block, Visit&& visit) const {
    for (std::int32_t p = first_[block]; p >= 0; p = next_[slot(p)]) visit(pool_[slot(p)]);
  }

 private:
  static constexpr int rows = 9;  ///< nodes that a brick's cells have along each axis
  using Signs = std::array<std::array<std::uint16_t, rows>, rows>;

  void markBlocks(std::uint32_t brick, const BrickBits& removed);
  void rebuildDirty(const CarvedField& field);
  void gatherSigns(const CarvedField& field, const Index3& brick);
  void freeBlock(std::uint32_t block);
  void makeBlock(std::uint32_t brick, std::uint32_t octant);
  void addCell(std::uint32_t block, unsigned inside, const std::array<std::uint32_t, 3>& at);
  SurfacePatch& openPatch(std::uint32_t block);
  std::uint8_t vertexInPatch(SurfacePatch& patch, unsigned edge, const std::array<std::uint32_t, 3>& at);
  void closePatch();
  void listBrick(std::uint32_t brick, std::uint16_t triangles);

  BrickLattice lattice_;
  const CubeTable& table_;
  std::vector<SurfacePatch> pool_;
  std::vector<std::int32_t> next_;   ///< patch of the same block, or next free one
  std::vector<std::int32_t> first_;  ///< of each block
  std::int32_t free_ = -1;
  std::int32_t open_ = -1;  ///< patch being filled
  std::vector<std::uint16_t> blockTriangles_;
  std::vector<std::uint16_t> brickTriangles_;
  std::vector<std::uint8_t> dirty_;  ///< blocks of each brick to be rebuilt
  std::vector<std::uint32_t> dirtyBrick_;
  std::vector<std::uint32_t> changedBlock_;
  std::vector<std::uint32_t> brick_;
  // Buffers of the current brick.
  Signs signs_{};                                            ///< [z][y], bit x
  std::array<std::array<std::uint32_t, rows>, 3> offset_{};  ///< index of a node: a sum over its coordinates
  std::vector<std::uint8_t> local_;                          ///< index of a lattice edge in the open patch, plus one
  std::vector<std::uint16_t> used_;                          ///< which of these are set
  std::size_t triangles_ = 0;
  std::size_t patches_ = 0;
  std::size_t growths_ = 0;
};

}  // namespace calot

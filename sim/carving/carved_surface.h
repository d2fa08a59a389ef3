// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a carved field for simulation: contact and volumes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

// Triangulation of the surface within a lattice cell.

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

/// Marching cubes over all cells (CubeTable), updated with the field: after a stroke, only blocks with a sign change
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

/// Adaptive polygonization after Velho (1996, "Simple and efficient polygonization of implicit surfaces", Journal of
/// Graphics Tools 1(2)): marching cubes on every other node, then each side of a triangle whose midpoint is farther
/// than `tolerance` from the surface is split there, and the new vertex is moved onto the surface along the field's
/// gradient. A triangle with one, two or three split sides becomes two, three or four.
///
/// Vertices of the base lie on lattice edges (if the sign changes over two edges in line, it changes over exactly one
/// of them). Whether and where a side is split depends on its two vertices alone, so neighbours agree: no cracks,
/// closed and manifold. Parts thinner than two cells may be missing here although CarvedSurface has them.
///
/// Parts are blocks of 4^3 cells (numbered as in SurfacePatch). update() rebuilds those within four nodes of a changed
/// value; the result equals that of rebuild(), bit for bit. Allocates while parts grow.
class AdaptiveSurface {
 public:
  static constexpr double tolerance = 0.2;  ///< cells

  struct Vertex {
    std::uint64_t key = 0;         ///< v << 32 | v on lattice edge v; v << 32 | w, v < w, in the middle of side v-w
    Vec3 position = Vec3::Zero();  ///< m, in the reference configuration
    Vec3 normal = Vec3::Zero();    ///< outward along the field's gradient, unit; zero if the gradient vanishes
  };
  struct Part {
    std::vector<Vertex> vertex;
    std::vector<std::array<std::uint8_t, 3>> triangle;  ///< into `vertex`, outward
  };

  explicit AdaptiveSurface(const BrickLattice& lattice);

  /// Rebuilds everything: at the start and after a restore.
  void rebuild(const CarvedField& field);
  /// Rebuilds what the last stroke changed. @pre the field was committed, and update() or rebuild()
  /// ran after every stroke
  void update(const CarvedField& field);

  /// Blocks rebuilt by the last update() or rebuild(), ascending, including empty ones.
  [[nodiscard]] std::span<const std::uint32_t> changedBlocks() const { return changedBlock_; }
  [[nodiscard]] const Part& part(std::uint32_t block) const { return part_[block]; }
  [[nodiscard]] std::uint32_t blocks() const { return static_cast<std::uint32_t>(part_.size()); }
  [[nodiscard]] std::size_t triangles() const { return triangles_; }

  /// The whole surface, vertices welded by key and numbered in order of blocks.
  [[nodiscard]] TriangleMesh mesh() const;
  [[nodiscard]] bool operator==(const AdaptiveSurface& other) const;

 private:
  struct Side {
    std::uint64_t key = 0;
    std::int16_t vertex = -1;  ///< at its midpoint; -1: not split
  };

  void mark(const CarvedField& field, std::uint32_t brick);
  void makeBlock(const CarvedField& field, std::uint32_t block);
  void makeCell(const CarvedField& field, Part& part, const Index3& cell);
  std::uint8_t baseVertex(const CarvedField& field, Part& part, const Index3& cell, unsigned edge);
  int middleVertex(const CarvedField& field, Part& part, std::uint8_t a, std::uint8_t b);
  [[nodiscard]] bool insideAt(const CarvedField& field, const Index3& node) const;

  BrickLattice lattice_;
  const CubeTable& table_;
  std::vector<Part> part_;
  std::vector<std::uint8_t> dirty_;
  std::vector<std::uint32_t> changedBlock_;
  std::vector<Side> side_;  ///< of the current block
  std::size_t triangles_ = 0;
};

// Interpolation of a carved field.

/// Value (m) and gradient (m per cell) at a point given in cells from the lattice's origin.
struct FieldSample {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// Trilinear within each cell: the value is continuous, the gradient is not. Points outside the lattice are
/// clamped to its border.
[[nodiscard]] FieldSample sampleField(const CarvedField& field, const Vec3& p);

/// The gradient where the surface cuts lattice edge `vertex` (surface_vertex): central differences at both ends,
/// interpolated. Continuous along the surface. (m per cell)
[[nodiscard]] Vec3 gradientAtVertex(const CarvedField& field, std::uint32_t vertex);

}  // namespace calot

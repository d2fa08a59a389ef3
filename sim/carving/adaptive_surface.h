// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a carved field for rendering: few triangles where it is flat, more where it is curved.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/carving/cube_table.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

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

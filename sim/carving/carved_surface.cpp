// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/carving/carved_surface.h"

#include <algorithm>

namespace calot {

namespace surface_vertex {

double cut(const CarvedField& field, std::uint32_t vertex) {
  const std::uint32_t node = vertex / 3;
  const double a = field.value(node);
  const double b = field.value(field.lattice().next(node, static_cast<int>(vertex % 3)));
  return std::clamp(a / (a - b), minCut, 1.0 - minCut);
}

Vec3 restPosition(const CarvedField& field, std::uint32_t vertex) {
  Vec3 p = field.lattice().nodeAt(vertex / 3).cast<double>();
  p[static_cast<int>(vertex % 3)] += cut(field, vertex);
  return field.lattice().origin() + field.lattice().cell() * p;
}

}  // namespace surface_vertex

CarvedSurface::CarvedSurface(const BrickLattice& lattice)
    : lattice_(lattice),
      table_(CubeTable::get()),
      first_(8 * lattice.brickCount(), -1),
      blockTriangles_(8 * lattice.brickCount(), 0),
      brickTriangles_(lattice.brickCount(), 0),
      dirty_(lattice.brickCount(), 0),
      local_(slot(3 * rows * rows * rows), 0) {
  dirtyBrick_.reserve(lattice.brickCount());
  brick_.reserve(lattice.brickCount());
  changedBlock_.reserve(8 * lattice.brickCount());
  used_.reserve(SurfacePatch::maxVertices);
}

void CarvedSurface::rebuild(const CarvedField& field) {
  dirtyBrick_.clear();
  for (std::uint32_t b = 0; b < lattice_.brickCount(); ++b) {
    dirty_[b] = 0xFF;
    dirtyBrick_.push_back(b);
  }
  rebuildDirty(field);
  const std::size_t capacity = 2 * patches_ + 64;
  pool_.reserve(capacity);
  next_.reserve(capacity);
}

void CarvedSurface::update(const CarvedField& field) {
  const std::size_t capacity = pool_.capacity();
  dirtyBrick_.clear();
  for (const std::uint32_t b : field.changed()) {
    const BrickBits removed = field.removed(b);
    if (anyBit(removed)) markBlocks(b, removed);
  }
  std::sort(dirtyBrick_.begin(), dirtyBrick_.end());
  rebuildDirty(field);
  growths_ += pool_.capacity() != capacity ? 1 : 0;
}

void CarvedSurface::markBlocks(std::uint32_t brick, const BrickBits& removed) {
  const Index3 origin = 2 * lattice_.brickAt(brick);
  const auto mark = [this](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0) return;
    const std::uint32_t b = lattice_.brick({x >> 1, y >> 1, z >> 1});
    if (dirty_[b] == 0) dirtyBrick_.push_back(b);
    dirty_[b] = static_cast<std::uint8_t>(dirty_[b] | 1U << static_cast<unsigned>((x & 1) + 2 * (y & 1) + 4 * (z & 1)));
  };
  // A node is a corner of the cells before it as well: at the start of a block, also of the previous block.
  constexpr std::uint64_t quarter = 0x0F0F0F0FULL;
  constexpr std::uint64_t quarterColumn = 0x01010101ULL;
  for (int z = 0; z < 8; ++z) {
    for (int q = 0; q < 4; ++q) {
      const int shift = 4 * (q & 1) + 32 * (q >> 1);
      const std::uint64_t part = removed[slot(z)] >> static_cast<unsigned>(shift) & quarter;
      if (part == 0) continue;
      const int x = origin[0] + (q & 1);
      const int y = origin[1] + (q >> 1);
      const int w = origin[2] + (z >> 2);
      for (int dz = 0; dz <= ((z & 3) == 0 ? 1 : 0); ++dz) {
        mark(x, y, w - dz);
        if ((part & quarterColumn) != 0) mark(x - 1, y, w - dz);
        if ((part & 0xFU) != 0) mark(x, y - 1, w - dz);
        if ((part & 1U) != 0) mark(x - 1, y - 1, w - dz);
      }
    }
  }
}

void CarvedSurface::rebuildDirty(const CarvedField& field) {
  changedBlock_.clear();
  for (const std::uint32_t b : dirtyBrick_) {
    const Index3 brick = lattice_.brickAt(b);
    gatherSigns(field, brick);
    for (int i = 0; i < rows; ++i) {
      for (int a = 0; a < 3; ++a) {
        Index3 n = Index3::Zero();
        n[a] = 8 * brick[a] + i;
        offset_[slot(a)][slot(i)] = lattice_.node(n);
      }
    }
    std::uint16_t triangles = brickTriangles_[b];
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      if ((dirty_[b] >> octant & 1U) == 0) continue;
      const std::uint32_t block = 8 * b + octant;
      triangles = static_cast<std::uint16_t>(triangles - blockTriangles_[block]);
      freeBlock(block);
      makeBlock(b, octant);
      triangles = static_cast<std::uint16_t>(triangles + blockTriangles_[block]);
      changedBlock_.push_back(block);
    }
    dirty_[b] = 0;
    listBrick(b, triangles);
  }
}

void CarvedSurface::listBrick(std::uint32_t brick, std::uint16_t triangles) {
  const bool was = brickTriangles_[brick] > 0;
  triangles_ += triangles;
  triangles_ -= brickTriangles_[brick];
  brickTriangles_[brick] = triangles;
  if (was == (triangles > 0)) return;
  const auto at = std::lower_bound(brick_.begin(), brick_.end(), brick);
  if (was) {
    brick_.erase(at);
  } else {
    brick_.insert(at, brick);
  }
}

void CarvedSurface::gatherSigns(const CarvedField& field, const Index3& brick) {
  // The brick and its neighbours towards +; beyond the lattice all is outside.
  static constexpr BrickBits none{};
  std::array<const BrickBits*, 8> bits{};
  for (int k = 0; k < 8; ++k) {
    const Index3 b = brick + Index3(k & 1, k >> 1 & 1, k >> 2);
    const bool there = (b.array() < lattice_.bricks().array()).all();
    bits[slot(k)] = there ? &field.bits(lattice_.brick(b)) : &none;
  }
  for (unsigned z = 0; z < rows; ++z) {
    for (unsigned y = 0; y < rows; ++y) {
      const std::size_t k = 2 * (y >> 3U) + 4 * (z >> 3U);
      const unsigned shift = 8 * (y & 7U);
      const std::uint64_t low = (*bits[k])[z & 7U] >> shift & 0xFFU;
      const std::uint64_t high = (*bits[k + 1])[z & 7U] >> shift & 1U;
      signs_[z][y] = static_cast<std::uint16_t>(low | high << 8U);
    }
  }
}

void CarvedSurface::freeBlock(std::uint32_t block) {
  for (std::int32_t p = first_[block]; p >= 0;) {
    const std::int32_t after = next_[slot(p)];
    next_[slot(p)] = free_;
    free_ = p;
    p = after;
    --patches_;
  }
  first_[block] = -1;
  blockTriangles_[block] = 0;
}

void CarvedSurface::makeBlock(std::uint32_t brick, std::uint32_t octant) {
  const std::uint32_t block = 8 * brick + octant;
  const std::uint32_t x0 = 4 * (octant & 1U);
  const std::uint32_t y0 = 4 * (octant >> 1U & 1U);
  const std::uint32_t z0 = 4 * (octant >> 2U);
  const unsigned mask = 0x1FU << x0;
  open_ = -1;
  for (std::uint32_t z = z0; z < z0 + 4; ++z) {
    for (std::uint32_t y = y0; y < y0 + 4; ++y) {
      const std::array<unsigned, 4> row{signs_[z][y] & mask, signs_[z][y + 1] & mask, signs_[z + 1][y] & mask,
                                        signs_[z + 1][y + 1] & mask};
      if ((row[0] | row[1] | row[2] | row[3]) == 0 || (row[0] & row[1] & row[2] & row[3]) == mask) continue;
      for (std::uint32_t x = x0; x < x0 + 4; ++x) {
        const unsigned inside =
            (row[0] >> x & 3U) | (row[1] >> x & 3U) << 2U | (row[2] >> x & 3U) << 4U | (row[3] >> x & 3U) << 6U;
        if (inside != 0 && inside != 0xFF) addCell(block, inside, {x, y, z});
      }
    }
  }
  closePatch();
}

void CarvedSurface::addCell(std::uint32_t block, unsigned inside, const std::array<std::uint32_t, 3>& at) {
  const CubeCase& c = table_[inside];
  const std::uint32_t cell = offset_[0][at[0]] + offset_[1][at[1]] + offset_[2][at[2]];
  for (std::uint32_t t = 0; t < c.count; ++t) {
    SurfacePatch& patch = openPatch(block);
    const std::size_t n = patch.triangleCount++;
    patch.triangle[n] = 8 * cell + t;
    for (std::size_t k = 0; k < 3; ++k) patch.corner[n][k] = vertexInPatch(patch, c.edge[t][k], at);
  }
  blockTriangles_[block] = static_cast<std::uint16_t>(blockTriangles_[block] + c.count);
}

SurfacePatch& CarvedSurface::openPatch(std::uint32_t block) {
  if (open_ >= 0 && pool_[slot(open_)].triangleCount < SurfacePatch::maxTriangles) return pool_[slot(open_)];
  const std::int32_t before = open_;
  closePatch();
  if (free_ < 0) {
    free_ = static_cast<std::int32_t>(pool_.size());
    pool_.emplace_back();
    next_.push_back(-1);
  }
  open_ = free_;
  free_ = next_[slot(open_)];
  next_[slot(open_)] = -1;
  SurfacePatch& patch = pool_[slot(open_)];
  patch.key = 8 * block;
  patch.triangleCount = 0;
  patch.vertexCount = 0;
  if (before < 0) {
    first_[block] = open_;
  } else {
    next_[slot(before)] = open_;
    patch.key = pool_[slot(before)].key + 1;
  }
  ++patches_;
  return patch;
}

std::uint8_t CarvedSurface::vertexInPatch(SurfacePatch& patch, unsigned edge, const std::array<std::uint32_t, 3>& at) {
  const unsigned axis = edge / 4;
  std::array<std::uint32_t, 3> n = at;
  n[(axis + 1) % 3] += edge & 1U;
  n[(axis + 2) % 3] += edge >> 1U & 1U;
  const std::size_t index = 3 * (n[0] + rows * (n[1] + rows * n[2])) + axis;
  if (local_[index] == 0) {
    patch.vertex[patch.vertexCount++] = 3 * (offset_[0][n[0]] + offset_[1][n[1]] + offset_[2][n[2]]) + axis;
    local_[index] = patch.vertexCount;
    used_.push_back(static_cast<std::uint16_t>(index));
  }
  return static_cast<std::uint8_t>(local_[index] - 1);
}

void CarvedSurface::closePatch() {
  for (const std::uint16_t index : used_) local_[index] = 0;
  used_.clear();
  open_ = -1;
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/fat/fat_body.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "sim/math/vectors.h"

namespace calot {

namespace {

using CubeMap = CarvedContact::CubeMap;

constexpr std::uint32_t brickNodes = BrickLattice::brickNodes;

/// Number of the block that a node lies in.
std::uint32_t blockOf(std::uint32_t node) {
  const std::uint32_t local = node % brickNodes;
  return 8 * (node / brickNodes) + (local >> 2U & 1U) + 2 * (local >> 5U & 1U) + 4 * (local >> 8U);
}

/// Index of a node in its block, x + 4 y + 16 z.
std::uint32_t indexInBlock(std::uint32_t node) {
  const std::uint32_t local = node % brickNodes;
  return (local & 3U) + 4 * (local >> 3U & 3U) + 16 * (local >> 6U & 3U);
}

// Faces of a block of 4^3 nodes in a word.
constexpr std::uint64_t firstX = 0x1111111111111111ULL;
constexpr std::uint64_t firstY = 0x000F000F000F000FULL;
constexpr std::uint64_t firstZ = 0x000000000000FFFFULL;

/// A block of a brick's nodes as a word.
std::uint64_t blockBits(const BrickBits& bits, std::uint32_t octant) {
  const unsigned shift = 4 * (octant & 1U) + 32 * (octant >> 1U & 1U);
  const std::size_t z0 = 4 * (octant >> 2U);
  std::uint64_t out = 0;
  for (unsigned z = 0; z < 4; ++z) {
    const std::uint64_t layer = bits[z0 + z] >> shift;
    const std::uint64_t rows =
        (layer & 0xFU) | (layer >> 4U & 0xF0U) | (layer >> 8U & 0xF00U) | (layer >> 12U & 0xF000U);
    out |= rows << (16U * z);
  }
  return out;
}

/// Trilinear maps of cubes with these corners. @param position three components and one of padding per node
CALOT_LANE_KERNEL void mapCubes(const Index8* cube, std::size_t count, const double* position, CubeMap* out) {
  for (std::size_t c = 0; c < count; ++c) {
    FourDoubles p[8];
    for (std::size_t k = 0; k < 8; ++k) readVector(position + 4 * static_cast<std::size_t>(cube[c][k]), p[k]);
    const FourDoubles x0 = p[1] - p[0];
    const FourDoubles x1 = p[3] - p[2];
    const FourDoubles x2 = p[5] - p[4];
    const FourDoubles x3 = p[7] - p[6];
    const FourDoubles y0 = p[2] - p[0];
    const FourDoubles y1 = p[6] - p[4];
    const FourDoubles map[8] = {p[0], x0, y0, p[4] - p[0], x1 - x0, x2 - x0, y1 - y0, (x3 - x2) - (x1 - x0)};
    for (std::size_t k = 0; k < 8; ++k) writeVector(map[k], out[c].data() + 4 * k);
  }
}

/// out = the maps at the nodes, four numbers each.
CALOT_LANE_KERNEL void mapNodes(const SkinNode* node, std::size_t count, const CubeMap* map, double* out) {
  for (std::size_t n = 0; n < count; ++n) {
    const double x = node[n].x;
    const double y = node[n].y;
    const double z = node[n].z;
    FourDoubles m[8];
    for (std::size_t k = 0; k < 8; ++k) readVector(map[node[n].cube].data() + 4 * k, m[k]);
    const FourDoubles low = (m[0] + x * m[1]) + y * (m[2] + x * m[4]);
    const FourDoubles high = (m[3] + x * m[5]) + y * (m[6] + x * m[7]);
    writeVector(FourDoubles(low + z * high), out + 4 * n);
  }
}

}  // namespace

CarvedContact::CarvedContact(const FatModel& model, const CarvedField& field)
    : model_(model), field_(field), adjacency_(field), surface_(*this, trianglesOfBlock * model.blocks().size()) {
  static_assert(SurfaceAdjacency::maxAround <= SurfaceTopology::maxAround);
  const std::size_t blocks = model.blocks().size();
  for (const std::uint32_t block : model.blocks()) {
    const std::uint32_t octant = block % 8;
    origin_.emplace_back(8 * model.lattice().brickAt(block / 8) + 4 * Index3(static_cast<int>(octant & 1U),
                                                                             static_cast<int>(octant >> 1U & 1U),
                                                                             static_cast<int>(octant >> 2U)));
  }
  mask_.assign(3 * blocks, 0);
  cut_.assign(nodesOfBlock * blocks, 0.0);
  cube_.assign(nodesOfBlock * blocks, -1);
  count_.assign(blocks, 0);
  first_.assign(blocks, 0);
  written_.assign(blocks, 0);
  dirty_.assign(blocks, 0);
  dirtyRank_.reserve(blocks);
}

int CarvedContact::nodeOf(std::uint32_t latticeEdge) const {
  const std::uint32_t node = latticeEdge / 3;
  const std::int32_t rank = model_.rankOfBlock(blockOf(node));
  assert(rank >= 0);
  return static_cast<int>(nodesOfBlock * static_cast<std::uint32_t>(rank) + 64 * (latticeEdge % 3) +
                          indexInBlock(node));
}

std::uint32_t CarvedContact::latticeEdgeOf(int node) const {
  const auto n = static_cast<std::uint32_t>(node);
  const std::uint32_t p = n % 64;
  const Index3 at = origin_[n / nodesOfBlock] +
                    Index3(static_cast<int>(p & 3U), static_cast<int>(p >> 2U & 3U), static_cast<int>(p >> 4U));
  return 3 * model_.lattice().node(at) + n % nodesOfBlock / 64;
}

std::uint32_t CarvedContact::triangleOf(std::uint32_t name) const {
  const std::int32_t rank = model_.rankOfBlock(blockOf(name / 8));
  assert(rank >= 0);
  // Names ascend in a block.
  std::uint32_t low = trianglesOfBlock * static_cast<std::uint32_t>(rank);
  std::uint32_t high = low + count_[slot(rank)];
  while (low < high) {
    const std::uint32_t middle = (low + high) / 2;
    if (surface_.name(middle) < name) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  assert(surface_.name(low) == name);
  return low;
}

std::size_t CarvedContact::across(std::size_t triangle, int k) const {
  return triangleOf(
      adjacency_.across(static_cast<std::uint32_t>(surface_.name(triangle)), static_cast<std::size_t>(k)));
}

std::size_t CarvedContact::around(int node, std::span<std::uint32_t, maxAround> out) const {
  const std::size_t count = adjacency_.around(latticeEdgeOf(node), out);
  for (std::size_t i = 0; i < count; ++i) out[i] = triangleOf(out[i]);
  return count;
}

void CarvedContact::rebuild(const CarvedSurface& surface) {
  for (std::uint32_t r = 0; r < count_.size(); ++r) {
    measure(r);
    writeBlock(surface, r);
  }
  listPatches(surface);
  // Reserve for what strokes may add.
  const std::size_t patches = 2 * patch_.size() + 2 * surface_.patches().size() + 64;
  for (int side = 0; side < 2; ++side) {
    patch_.reserve(patches);
    cornerStart_.reserve(patches + 1);
    corner_.reserve(64 * patches);
    surface_.setPatches(patch_, cornerStart_, corner_);
  }
  listNodes();
  skinNode_.reserve(2 * skinNode_.size() + 64);
  placed_.reserve(4 * skinNode_.capacity());
}

void CarvedContact::update(const CarvedSurface& surface) {
  markRaised();
  std::sort(dirtyRank_.begin(), dirtyRank_.end());
  for (const std::uint32_t r : dirtyRank_) {
    dirty_[r] = 0;
    measure(r);
  }
  if (surface.changedBlocks().empty()) return;
  for (const std::uint32_t block : surface.changedBlocks()) {
    const std::int32_t rank = model_.rankOfBlock(block);
    if (rank >= 0) writeBlock(surface, static_cast<std::uint32_t>(rank));
  }
  const std::size_t capacity = corner_.capacity() + patch_.capacity() + cornerStart_.capacity();
  listPatches(surface);
  growths_ += listed_ != capacity ? 1 : 0;
}

/// Blocks that own an edge with a raised end.
void CarvedContact::markRaised() {
  dirtyRank_.clear();
  for (const std::uint32_t brick : field_.changed()) {
    const BrickBits& raised = field_.raised(brick);
    const Index3 first = 2 * model_.lattice().brickAt(brick);
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const std::uint64_t bits = blockBits(raised, octant);
      if (bits == 0) continue;
      const Index3 block = first + Index3(static_cast<int>(octant & 1U), static_cast<int>(octant >> 1U & 1U),
                                          static_cast<int>(octant >> 2U));
      mark(block);
      if ((bits & firstX) != 0) mark(block - Index3::Unit(0));
      if ((bits & firstY) != 0) mark(block - Index3::Unit(1));
      if ((bits & firstZ) != 0) mark(block - Index3::Unit(2));
    }
  }
}

void CarvedContact::mark(const Index3& block) {
  if ((block.array() < 0).any()) return;
  const std::uint32_t brick = model_.lattice().brick({block[0] >> 1, block[1] >> 1, block[2] >> 1});
  const std::int32_t rank = model_.rankOfBlock(
      8 * brick + static_cast<std::uint32_t>((block[0] & 1) + 2 * (block[1] & 1) + 4 * (block[2] & 1)));
  if (rank < 0 || dirty_[slot(rank)] != 0) return;
  dirty_[slot(rank)] = 1;
  dirtyRank_.push_back(static_cast<std::uint32_t>(rank));
}

/// A block's inside nodes; none beyond the lattice.
std::uint64_t CarvedContact::insideOfBlock(const Index3& block) const {
  const Index3 brick(block[0] >> 1, block[1] >> 1, block[2] >> 1);
  if ((brick.array() >= model_.lattice().bricks().array()).any()) return 0;
  return blockBits(field_.bits(model_.lattice().brick(brick)),
                   static_cast<std::uint32_t>((block[0] & 1) + 2 * (block[1] & 1) + 4 * (block[2] & 1)));
}

/// Finds which edges of a block are cut, where, and their cubes.
void CarvedContact::measure(std::uint32_t rank) {
  nodesListed_ = false;
  const Index3 block = origin_[rank] / 4;
  const std::uint64_t inside = insideOfBlock(block);
  const std::uint64_t next[3] = {
      (inside >> 1U & ~(firstX << 3U)) | (insideOfBlock(block + Index3::Unit(0)) & firstX) << 3U,
      (inside >> 4U & ~(firstY << 12U)) | (insideOfBlock(block + Index3::Unit(1)) & firstY) << 12U,
      inside >> 16U | (insideOfBlock(block + Index3::Unit(2)) & firstZ) << 48U};
  for (unsigned axis = 0; axis < 3; ++axis) {
    const std::uint64_t cut = inside ^ next[axis];
    mask_[3 * rank + axis] = cut;
    for (std::uint64_t left = cut; left != 0; left &= left - 1) {
      const auto p = static_cast<unsigned>(std::countr_zero(left));
      const Index3 lower =
          origin_[rank] + Index3(static_cast<int>(p & 3U), static_cast<int>(p >> 2U & 3U), static_cast<int>(p >> 4U));
      const std::size_t node = nodesOfBlock * rank + 64 * axis + p;
      cut_[node] = surface_vertex::cut(field_, 3 * model_.lattice().node(lower) + axis);
      const bool lowerInside = (inside >> p & 1U) != 0;
      cube_[node] = model_.cubeOfNode(lowerInside ? lower : Index3(lower + Index3::Unit(static_cast<int>(axis))));
    }
  }
}

void CarvedContact::writeBlock(const CarvedSurface& surface, std::uint32_t rank) {
  std::uint32_t count = 0;
  surface.forEachPatchOfBlock(model_.blocks()[rank], [&](const SurfacePatch& patch) {
    for (std::size_t t = 0; t < patch.triangleCount; ++t) {
      const Index3 corners(nodeOf(patch.vertexOf(t, 0)), nodeOf(patch.vertexOf(t, 1)), nodeOf(patch.vertexOf(t, 2)));
      surface_.setTriangle(trianglesOfBlock * rank + count++, corners, patch.triangle[t]);
    }
  });
  assert(count <= trianglesOfBlock);
  count_[rank] = static_cast<std::uint16_t>(count);
  written_[rank] = 1;
}

/// Lists the patches in order with their corners; those of unchanged blocks are copied.
void CarvedContact::listPatches(const CarvedSurface& surface) {
  patch_.clear();
  cornerStart_.clear();
  corner_.clear();
  for (const std::uint32_t brick : surface.bricks()) {
    for (std::uint32_t block = 8 * brick; block < 8 * brick + 8; ++block) {
      const std::int32_t ranked = model_.rankOfBlock(block);
      if (ranked < 0 || count_[slot(ranked)] == 0) continue;
      const auto rank = static_cast<std::uint32_t>(ranked);
      const std::uint32_t first = trianglesOfBlock * rank;
      const auto patches =
          static_cast<std::uint32_t>((count_[rank] + SurfacePatch::maxTriangles - 1) / SurfacePatch::maxTriangles);
      for (std::uint32_t p = 0; p < patches; ++p) {
        const std::size_t from = first + SurfacePatch::maxTriangles * p;
        patch_.push_back({from, std::min(from + SurfacePatch::maxTriangles, std::size_t{first} + count_[rank])});
        cornerStart_.push_back(corner_.size());
        if (written_[rank] == 0) {
          const std::span<const int> old = surface_.patchCorners(first_[rank] + p);
          corner_.insert(corner_.end(), old.begin(), old.end());
        }
      }
      if (written_[rank] != 0) {
        std::size_t at = cornerStart_.size() - patches;
        surface.forEachPatchOfBlock(block, [&](const SurfacePatch& patch) {
          cornerStart_[at++] = corner_.size();
          const auto start = static_cast<std::ptrdiff_t>(corner_.size());
          for (std::size_t v = 0; v < patch.vertexCount; ++v) corner_.push_back(nodeOf(patch.vertex[v]));
          std::sort(corner_.begin() + start, corner_.end());
        });
      }
      written_[rank] = 0;
      first_[rank] = static_cast<std::uint32_t>(patch_.size()) - patches;
    }
  }
  cornerStart_.push_back(corner_.size());
  listed_ = corner_.capacity() + patch_.capacity() + cornerStart_.capacity();
  surface_.setPatches(patch_, cornerStart_, corner_);
}

Vec3 CarvedContact::cellsOf(std::size_t node) const {
  const std::size_t p = node % 64;
  Vec3 cells = (origin_[node / nodesOfBlock] +
                Index3(static_cast<int>(p & 3U), static_cast<int>(p >> 2U & 3U), static_cast<int>(p >> 4U)))
                   .cast<double>();
  cells[static_cast<int>(node % nodesOfBlock / 64)] += cut_[node];
  return cells;
}

void CarvedContact::positions(std::span<const Vec3> solid, std::vector<Vec3>& out) const {
  out.resize(nodeCapacity(), Vec3::Zero());
  const std::vector<Index8>& cubes = model_.solid().cubes();
  padded_.resize(4 * solid.size());
  for (std::size_t n = 0; n < solid.size(); ++n) std::copy_n(solid[n].data(), 3, padded_.data() + 4 * n);
  map_.resize(cubes.size());
  mapCubes(cubes.data(), cubes.size(), padded_.data(), map_.data());
  if (!nodesListed_) listNodes();
  placed_.resize(4 * skinNode_.size());
  mapNodes(skinNode_.data(), skinNode_.size(), map_.data(), placed_.data());
  for (std::size_t n = 0; n < skinNode_.size(); ++n) {
    const double* from = placed_.data() + 4 * n;
    out[skinNode_[n].number] = Vec3(from[0], from[1], from[2]);
  }
}

void CarvedContact::listNodes() const {
  const int k = model_.cellsPerCube();
  const double inEdges = 1.0 / static_cast<double>(k);
  skinNode_.clear();
  for (std::size_t word = 0; word < mask_.size(); ++word) {
    const std::size_t axis = word % 3;
    const Index3& origin = origin_[word / 3];
    for (std::uint64_t left = mask_[word]; left != 0; left &= left - 1) {
      const auto p = static_cast<int>(std::countr_zero(left));
      const std::size_t n = 64 * word + slot(p);
      const int cube = cube_[n];
      const Index3& h = model_.hexahedronOfCube(cube);
      double cells[3] = {static_cast<double>(origin[0] + (p & 3) - k * h[0]),
                         static_cast<double>(origin[1] + (p >> 2 & 3) - k * h[1]),
                         static_cast<double>(origin[2] + (p >> 4) - k * h[2])};
      cells[axis] += cut_[n];
      skinNode_.push_back(
          {inEdges * cells[0], inEdges * cells[1], inEdges * cells[2], static_cast<std::uint32_t>(n), cube});
    }
  }
  nodesListed_ = true;
}

MaterialPoint CarvedContact::anchor(int node) const {
  const int cube = cube_[static_cast<std::size_t>(node)];
  MaterialPoint point;
  point.node = model_.solid().cubes()[slot(cube)];
  point.weight = model_.shares(cube, cellsOf(static_cast<std::size_t>(node)));
  point.count = 8;
  return point;
}

SolidSolver::Impulse CarvedContact::influence(const std::array<int, 3>& corner, const Vec3& weight) const {
  SolidSolver::Impulse out;
  for (std::size_t c = 0; c < 3; ++c) {
    const double own = weight[static_cast<int>(c)];
    if (own == 0.0) continue;
    const MaterialPoint point = anchor(corner[c]);
    for (std::size_t a = 0; a < point.count; ++a) {
      const double share = own * point.weight[a];
      if (share == 0.0) continue;
      std::size_t k = 0;
      while (k < out.count && out.node[k] != point.node[a]) ++k;
      if (k == out.count) out.node[out.count++] = point.node[a];
      out.weight[k] += share;
    }
  }
  return out;
}

}  // namespace calot

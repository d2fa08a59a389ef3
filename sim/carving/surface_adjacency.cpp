// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/surface_adjacency.h"

#include <cassert>

namespace calot {

unsigned SurfaceAdjacency::caseOf(std::uint32_t cell) const {
  const BrickLattice& lattice = field_.lattice();
  // A cell on the lattice's last nodes has corners beyond it, all of them outside.
  const Index3 last = 8 * lattice.bricks().array() - 1;
  const Index3 at = lattice.nodeAt(cell);
  unsigned inside = 0;
  for (int c = 0; c < 8; ++c) {
    const Index3 n = at + Index3(c & 1, c >> 1 & 1, c >> 2);
    if ((n.array() > last.array()).any()) continue;
    inside |= static_cast<unsigned>(field_.inside(lattice.node(n))) << static_cast<unsigned>(c);
  }
  return inside;
}

std::uint32_t SurfaceAdjacency::vertexOf(std::uint32_t cell, unsigned edge) const {
  const BrickLattice& lattice = field_.lattice();
  const unsigned axis = edge / 4;
  std::uint32_t node = cell;
  if ((edge & 1U) != 0) node = lattice.next(node, static_cast<int>((axis + 1) % 3));
  if ((edge & 2U) != 0) node = lattice.next(node, static_cast<int>((axis + 2) % 3));
  return 3 * node + axis;
}

bool SurfaceAdjacency::exists(std::uint32_t triangle) const {
  const std::uint32_t cell = triangle / 8;
  return cell < field_.lattice().storage() && triangle % 8 < table_[caseOf(cell)].count;
}

std::array<std::uint32_t, 3> SurfaceAdjacency::vertices(std::uint32_t triangle) const {
  const std::uint32_t cell = triangle / 8;
  const auto& edge = table_[caseOf(cell)].edge[triangle % 8];
  return {vertexOf(cell, edge[0]), vertexOf(cell, edge[1]), vertexOf(cell, edge[2])};
}

std::uint32_t SurfaceAdjacency::across(std::uint32_t triangle, std::size_t k) const {
  const std::uint32_t cell = triangle / 8;
  const CubeCase& here = table_[caseOf(cell)];
  const std::uint32_t t = triangle % 8;
  const int across = here.across[t][k];
  if (across >= 0) return 8 * cell + static_cast<std::uint32_t>(across);
  const auto face = static_cast<unsigned>(-1 - across);
  const int axis = static_cast<int>(face / 2);
  const std::uint32_t beyond =
      (face & 1U) != 0 ? field_.lattice().next(cell, axis) : field_.lattice().previous(cell, axis);
  const unsigned from = edgeFromBeyond(here.edge[t][k], face);
  const unsigned to = edgeFromBeyond(here.edge[t][(k + 1) % 3], face);
  const CubeCase& there = table_[caseOf(beyond)];
  for (std::uint32_t other = 0; other < there.count; ++other) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (there.edge[other][j] == to && there.edge[other][(j + 1) % 3] == from) return 8 * beyond + other;
    }
  }
  assert(false);
  return triangle;
}

std::size_t SurfaceAdjacency::around(std::uint32_t vertex, std::span<std::uint32_t> out) const {
  const BrickLattice& lattice = field_.lattice();
  const std::uint32_t node = vertex / 3;
  const unsigned axis = vertex % 3;
  const int u = static_cast<int>((axis + 1) % 3);
  const int v = static_cast<int>((axis + 2) % 3);
  const Index3 at = lattice.nodeAt(node);
  std::size_t count = 0;
  for (unsigned k = 4; k-- > 0;) {  // the four cells around the edge, the lowest first
    if (((k & 1U) != 0 && at[u] == 0) || ((k & 2U) != 0 && at[v] == 0)) continue;
    std::uint32_t cell = node;
    if ((k & 1U) != 0) cell = lattice.previous(cell, u);
    if ((k & 2U) != 0) cell = lattice.previous(cell, v);
    const CubeCase& c = table_[caseOf(cell)];
    const unsigned edge = 4 * axis + k;
    for (std::uint32_t t = 0; t < c.count; ++t) {
      if (c.edge[t][0] == edge || c.edge[t][1] == edge || c.edge[t][2] == edge) out[count++] = 8 * cell + t;
    }
  }
  return count;
}

}  // namespace calot

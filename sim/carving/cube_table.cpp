// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_surface.h"

#include <algorithm>
#include <cassert>

namespace calot {
namespace {

constexpr int never = 1 << 20;

/// A loop of at most 12 cut edges and its cheapest triangulation: shortest inner sides, none on a face.
class Loop {
 public:
  void add(unsigned edge) { edge_[size_++] = edge; }
  [[nodiscard]] std::size_t size() const { return size_; }

  void fill(CubeCase& out) {
    for (std::size_t length = 2; length < size_; ++length) {
      for (std::size_t i = 0; i + length < size_; ++i) {
        const std::size_t j = i + length;
        cost_[i][j] = never;
        for (std::size_t k = i + 1; k < j; ++k) {
          const int cost = cost_[i][k] + cost_[k][j] + side(i, k) + side(k, j);
          if (cost >= cost_[i][j]) continue;
          cost_[i][j] = cost;
          apex_[i][j] = k;
        }
      }
    }
    assert(cost_[0][size_ - 1] < never);
    emit(0, size_ - 1, out);
  }

 private:
  /// Squared length of a side between the midpoints of two edges, in quarter cells; zero for sides of the loop.
  [[nodiscard]] int side(std::size_t i, std::size_t j) const {
    if (j - i == 1 || j - i == size_ - 1) return 0;
    if ((facesOfEdge(edge_[i]) & facesOfEdge(edge_[j])) != 0) return never;
    int sum = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int d = twice(edge_[i], axis) - twice(edge_[j], axis);
      sum += d * d;
    }
    return sum;
  }
  /// Twice the coordinate of an edge's midpoint.
  static int twice(unsigned edge, unsigned axis) {
    const unsigned a = edge / 4;
    if (axis == a) return 1;
    return axis == (a + 1) % 3 ? 2 * static_cast<int>(edge & 1U) : 2 * static_cast<int>(edge >> 1U & 1U);
  }
  void emit(std::size_t i, std::size_t j, CubeCase& out) {
    if (j - i < 2) return;
    const std::size_t k = apex_[i][j];
    assert(out.count < CubeCase::maxTriangles);
    out.edge[out.count++] = {static_cast<std::uint8_t>(edge_[i]), static_cast<std::uint8_t>(edge_[k]),
                             static_cast<std::uint8_t>(edge_[j])};
    emit(i, k, out);
    emit(k, j, out);
  }

  std::array<unsigned, 12> edge_{};
  std::size_t size_ = 0;
  std::array<std::array<int, 12>, 12> cost_{};
  std::array<std::array<std::size_t, 12>, 12> apex_{};
};

unsigned corner(unsigned axis, unsigned along, unsigned u, unsigned v) {
  return along << axis | u << (axis + 1) % 3 | v << (axis + 2) % 3;
}

/// The edge between two neighbouring corners.
unsigned edgeBetween(unsigned c, unsigned d) {
  const unsigned difference = c ^ d;
  const unsigned a = difference == 1 ? 0 : (difference == 2 ? 1 : 2);
  return 4 * a + (c >> (a + 1) % 3 & 1U) + 2 * (c >> (a + 2) % 3 & 1U);
}

/// Successor of each cut edge in its loop, oriented so that the loop faces outside.
std::array<int, 12> successors(unsigned inside) {
  std::array<int, 12> next{};
  next.fill(-1);
  for (unsigned face = 0; face < 6; ++face) {
    const unsigned axis = face / 2;
    const unsigned s = face & 1U;
    // Counter-clockwise as seen from outside of the cell.
    std::array<unsigned, 4> ring{corner(axis, s, 0, 0), corner(axis, s, 1, 0), corner(axis, s, 1, 1),
                                 corner(axis, s, 0, 1)};
    if (s == 0) std::swap(ring[1], ring[3]);
    const auto in = [&](unsigned i) { return (inside >> ring[i % 4] & 1U) != 0; };
    for (unsigned i = 0; i < 4; ++i) {
      if (!in(i) || in(i + 3)) continue;  // a run of inside corners begins at i
      unsigned j = i;
      while (in(j + 1)) ++j;
      const unsigned entry = edgeBetween(ring[(i + 3) % 4], ring[i]);
      const unsigned exit = edgeBetween(ring[j % 4], ring[(j + 1) % 4]);
      next[entry] = static_cast<int>(exit);
    }
  }
  return next;
}

void findAcross(CubeCase& c) {
  for (std::size_t t = 0; t < c.count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned from = c.edge[t][k];
      const unsigned to = c.edge[t][(k + 1) % 3];
      const unsigned shared = facesOfEdge(from) & facesOfEdge(to);
      int found = never;
      if (shared != 0) {
        for (int f = 0; f < 6; ++f) {
          if ((shared >> static_cast<unsigned>(f) & 1U) != 0) found = -1 - f;
        }
      }
      for (std::size_t other = 0; other < c.count && shared == 0; ++other) {
        for (std::size_t j = 0; j < 3; ++j) {
          if (c.edge[other][j] == to && c.edge[other][(j + 1) % 3] == from) found = static_cast<int>(other);
        }
      }
      assert(found != never);
      c.across[t][k] = static_cast<std::int16_t>(found);
    }
  }
}

}  // namespace

CubeTable::CubeTable() {
  for (unsigned inside = 0; inside < 256; ++inside) {
    std::array<int, 12> next = successors(inside);
    CubeCase& c = case_[inside];
    for (unsigned start = 0; start < 12; ++start) {
      if (next[start] < 0) continue;
      Loop loop;
      for (unsigned e = start; next[e] >= 0;) {
        loop.add(e);
        const auto following = static_cast<unsigned>(next[e]);
        next[e] = -1;
        e = following;
      }
      loop.fill(c);
    }
    findAcross(c);
  }
}

const CubeTable& CubeTable::get() {
  static const CubeTable table;
  return table;
}

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

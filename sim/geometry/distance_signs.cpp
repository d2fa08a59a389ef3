// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/distance_signs.h"

#include <array>
#include <cmath>

#include "sim/geometry/surface_distance.h"

namespace calot {
namespace {

constexpr double tolerance = 1e-9;  // cells

/// Signs along one row of a brick; unknown values (the band) take their neighbour's sign. @return the
/// row's signs as bits
unsigned spreadRow(double* row, int count, double band, bool& inside) {
  bool known = false;
  for (int x = 0; x < 8; ++x) known |= row[x] != band;
  if (!known && !inside) return 0;
  unsigned bits = 0;
  for (int x = 0; x < count; ++x) {
    if (row[x] != band) {
      inside = row[x] < 0.0;
    } else if (inside) {
      row[x] = -band;
    }
    bits |= static_cast<unsigned>(row[x] < 0.0) << static_cast<unsigned>(x);
  }
  return bits;
}

/// Do neighbouring values agree, with a surface between them if their signs differ?
bool agree(double x, double y) { return (x < 0.0) == (y < 0.0) || std::abs(x) + std::abs(y) <= 1.0 + tolerance; }

}  // namespace

bool spreadSigns(const BrickLattice& lattice, double band, std::vector<double>& value) {
  const Index3& nodes = lattice.nodes();
  const Index3& bricks = lattice.bricks();
  constexpr std::uint32_t brickNodes = BrickLattice::brickNodes;
  // Signs of a row of a brick as a byte, so that rows can be compared whole.
  const std::size_t rows = lattice.storage() / 8;
  std::vector<std::uint8_t> sign(rows, 0);
  // Brick by brick, in memory order, with the state of the 64 rows that run through a line of bricks.
  for (int line = 0; line < bricks[1] * bricks[2]; ++line) {
    const int by = line % bricks[1];
    const int bz = line / bricks[1];
    std::array<bool, 64> inside{};
    for (int bx = 0; bx < bricks[0]; ++bx) {
      double* brick = value.data() + std::size_t{lattice.brick({bx, by, bz})} * brickNodes;
      const int count = std::min(8, nodes[0] - 8 * bx);
      for (int i = 0; i < 64; ++i) {
        if (8 * by + (i & 7) >= nodes[1] || 8 * bz + (i >> 3) >= nodes[2]) continue;
        double* row = brick + 8 * i;
        const bool before = inside[slot(i)];
        const unsigned bits = spreadRow(row, count, band, inside[slot(i)]);
        sign[slot(static_cast<int>((row - value.data()) / 8))] = static_cast<std::uint8_t>(bits);
        const unsigned change = (bits ^ ((bits << 1U) | static_cast<unsigned>(before))) & 0xFFU;
        for (unsigned x = 0; x < 8 && change >> x != 0; ++x) {
          if ((change >> x & 1U) == 0) continue;
          const double left = x > 0 ? row[x - 1] : (bx > 0 ? (row - brickNodes)[7] : band);
          if (!agree(left, row[x])) return false;
        }
      }
    }
    for (const bool in : inside) {
      if (in) return false;  // the border is outside
    }
  }
  // Across rows.
  for (int axis = 1; axis < 3; ++axis) {
    for (int z = 0; z < nodes[2]; ++z) {
      for (int y = 0; y < nodes[1]; ++y) {
        Index3 n(0, y, z);
        std::uint32_t here = lattice.node(n);
        ++n[axis];
        const bool border = n[axis] >= nodes[axis];
        std::uint32_t there = border ? 0 : lattice.node(n);
        for (int bx = 0; bx < bricks[0]; ++bx, here += brickNodes, there += brickNodes) {
          const unsigned change = sign[here / 8] ^ (border ? 0U : sign[there / 8]);
          for (unsigned x = 0; change >> x != 0; ++x) {
            if ((change >> x & 1U) != 0 && !agree(value[here + x], border ? band : value[there + x])) return false;
          }
        }
      }
    }
  }
  return true;
}

void signByRegions(const TriangleMesh& mesh, const BrickLattice& lattice, double band, std::vector<double>& value) {
  const SurfaceDistance surface(mesh, InsideRule::winding);
  for (double& d : value) d = std::min(std::abs(d), band);
  std::vector<std::uint8_t> seen(value.size(), 0);
  std::vector<Index3> stack;
  std::vector<double> size = value;
  const auto flood = [&](const Index3& from, bool inside) {
    stack.assign(1, from);
    seen[lattice.node(from)] = 1;
    while (!stack.empty()) {
      const Index3 n = stack.back();
      stack.pop_back();
      const std::uint32_t here = lattice.node(n);
      if (inside) value[here] = -size[here];
      for (int a = 0; a < 3; ++a) {
        for (const int step : {-1, 1}) {
          Index3 m = n;
          m[a] += step;
          if (!lattice.contains(m)) continue;
          const std::uint32_t there = lattice.node(m);
          if (seen[there] != 0 || !(size[here] + size[there] > 1.0 + tolerance)) continue;
          seen[there] = 1;
          stack.push_back(m);
        }
      }
    }
  };
  Index3 n;
  for (n[2] = 0; n[2] < lattice.nodes()[2]; ++n[2]) {
    for (n[1] = 0; n[1] < lattice.nodes()[1]; ++n[1]) {
      for (n[0] = 0; n[0] < lattice.nodes()[0]; ++n[0]) {
        if (seen[lattice.node(n)] != 0) continue;
        flood(n, surface.windingNumber(lattice.position(n)) > 0.5);
      }
    }
  }
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/distance_signs.h"

#include <array>
#include <cmath>

#include "sim/geometry/surface_distance.h"

namespace calot {
namespace {

constexpr double tolerance = 1e-9;  // cells

/// Signs along one row of a brick's length. @return false at a contradiction
bool spreadRow(double* row, int count, double band, bool& inside) {
  for (int x = 0; x < count; ++x) {
    const double value = row[x];
    if (value == band) {  // unknown: like its neighbour
      if (inside) row[x] = -band;
      continue;
    }
    inside = value < 0.0;
  }
  return true;
}

/// Neighbours of unlike sign a surface apart?
bool agree(double x, double y) { return (x < 0.0) == (y < 0.0) || std::abs(x) + std::abs(y) <= 1.0 + tolerance; }

}  // namespace

bool spreadSigns(const BrickLattice& lattice, double band, std::vector<double>& value) {
  const Index3& nodes = lattice.nodes();
  const Index3& bricks = lattice.bricks();
  constexpr std::uint32_t brickNodes = BrickLattice::brickNodes;
  // Signs of a row of a brick as a byte, so that rows can be compared whole.
  const std::size_t rows = lattice.storage() / 8;
  std::vector<std::uint8_t> sign(rows, 0);
  for (int z = 0; z < nodes[2]; ++z) {
    for (int y = 0; y < nodes[1]; ++y) {
      bool inside = false;
      std::uint32_t at = lattice.node({0, y, z});
      for (int bx = 0; bx < bricks[0]; ++bx, at += brickNodes) {
        double* row = value.data() + at;
        const bool before = inside;
        spreadRow(row, std::min(8, nodes[0] - 8 * bx), band, inside);
        unsigned bits = 0;
        for (unsigned x = 0; x < 8; ++x) bits |= static_cast<unsigned>(row[x] < 0.0) << x;
        sign[at / 8] = static_cast<std::uint8_t>(bits);
        const unsigned change = bits ^ ((bits << 1U) | static_cast<unsigned>(before));
        for (unsigned x = 0; x < 8; ++x) {
          if ((change >> x & 1U) == 0) continue;
          const double left = x > 0 ? row[x - 1] : (bx > 0 ? (row - brickNodes)[7] : band);
          if (!agree(left, row[x])) return false;
        }
      }
      if (inside) return false;  // the border is outside
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

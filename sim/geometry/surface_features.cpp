// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/geometry/closest_point_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sim/geometry/surface_distance.h"
#include "sim/math/elementary.h"

namespace calot {

SurfaceFeatures::SurfaceFeatures(std::span<const Vec3> vertex, std::span<const Index3> triangle) {
  face_.resize(triangle.size());
  vertexNormal_.assign(vertex.size(), Vec3::Zero());
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    std::array<const Vec3*, 3> p{};
    for (int k = 0; k < 3; ++k) p[slot(k)] = &vertex[slot(triangle[t][k])];
    const Vec3 ab = *p[1] - *p[0];
    const Vec3 ac = *p[2] - *p[0];
    const Vec3 normal = ab.cross(ac);
    if (!(normal.squaredNorm() > 1e-20 * ab.squaredNorm() * ac.squaredNorm())) continue;
    Face& face = face_[t];
    face.normal = normal / normal.norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = *p[(k + 1) % 3] - *p[k];
      const Vec3 v = *p[(k + 2) % 3] - *p[k];
      const Vec3 inward = face.normal.cross(u);
      face.inward[k] = inward / inward.norm();
      const double angle = arctangent2(u.cross(v).norm(), u.dot(v));
      vertexNormal_[slot(triangle[t][static_cast<int>(k)])] += angle * face.normal;
    }
  }
  makeEdges(vertex.size(), triangle);
}

void SurfaceFeatures::makeEdges(std::size_t vertices, std::span<const Index3> triangle) {
  // Sides into buckets by their lower vertex, a few to each, sorted there.
  std::vector<int> start(vertices + 1, 0);
  for (const Index3& v : triangle) {
    for (int k = 0; k < 3; ++k) ++start[slot(std::min(v[k], v[(k + 1) % 3])) + 1];
  }
  for (std::size_t i = 1; i <= vertices; ++i) start[i] += start[i - 1];
  side_.resize(3 * triangle.size());
  std::vector<int> at(start.begin(), start.end() - 1);
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangle[t][k];
      const int to = triangle[t][(k + 1) % 3];
      const int low = std::min(from, to);
      side_[slot(at[slot(low)]++)] = {static_cast<int>(t), k, low, std::max(from, to), from < to};
    }
  }
  const auto before = [](const Side& x, const Side& y) {
    return std::tie(x.high, x.triangle, x.side) < std::tie(y.high, y.triangle, y.side);
  };
  edge_.reserve(side_.size() / 2 + 1);
  aroundStart_.assign(vertices + 1, 0);
  for (std::size_t low = 0; low < vertices; ++low) {
    const int last = start[low + 1];
    std::sort(side_.begin() + start[low], side_.begin() + last, before);
    for (int i = start[low]; i < last;) {
      Edge edge;
      edge.low = static_cast<int>(low);
      edge.high = side_[slot(i)].high;
      edge.first = i;
      int balance = 0;
      for (; i < last && side_[slot(i)].high == edge.high; ++i) {
        const Side& side = side_[slot(i)];
        balance += side.forward ? 1 : -1;
        edge.normal += face_[slot(side.triangle)].normal;
      }
      edge.last = i;
      openEdges_ += balance != 0 ? 1 : 0;
      manifold_ = manifold_ && balance == 0 && edge.last - edge.first == 2;
      ++aroundStart_[low + 1];
      ++aroundStart_[slot(edge.high) + 1];
      edge_.push_back(edge);
    }
  }
  for (std::size_t i = 1; i <= vertices; ++i) aroundStart_[i] += aroundStart_[i - 1];
  around_.resize(2 * edge_.size());
  at.assign(aroundStart_.begin(), aroundStart_.end() - 1);
  for (std::size_t e = 0; e < edge_.size(); ++e) {
    around_[slot(at[slot(edge_[e].low)]++)] = static_cast<int>(e);
    around_[slot(at[slot(edge_[e].high)]++)] = static_cast<int>(e);
  }
}

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
  forEachIndex(Index3::Zero(), lattice.nodes().array() - 1, [&](const Index3& n) {
    if (seen[lattice.node(n)] == 0) flood(n, surface.windingNumber(lattice.position(n)) > 0.5);
  });
}

}  // namespace calot

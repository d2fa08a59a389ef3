// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace calot {
namespace {

using Point = std::int64_t;
/// A vertex of the mesh: (p, p) is lattice point p, (p, q) with p < q the cut on that edge.
using Key = std::pair<Point, Point>;

struct Neighbour {
  Point point = 0;
  bool isLong = false;
};

/// Index arithmetic of the lattice.
class Grid {
 public:
  explicit Grid(const BccLattice& lattice)
      : nx_(lattice.size[0]), ny_(lattice.size[1]), nz_(lattice.size[2]), corners_(nx_ * ny_ * nz_) {}

  [[nodiscard]] Point corner(Point i, Point j, Point k) const { return i + nx_ * (j + ny_ * k); }
  [[nodiscard]] Point centre(Point i, Point j, Point k) const { return corners_ + i + (nx_ - 1) * (j + (ny_ - 1) * k); }
  [[nodiscard]] bool hasCorner(Point i, Point j, Point k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < nx_ && j < ny_ && k < nz_;
  }
  [[nodiscard]] bool hasCentre(Point i, Point j, Point k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < nx_ - 1 && j < ny_ - 1 && k < nz_ - 1;
  }
  [[nodiscard]] std::array<Point, 3> coordinates(Point p) const {
    if (p < corners_) return {p % nx_, p / nx_ % ny_, p / (nx_ * ny_)};
    p -= corners_;
    return {p % (nx_ - 1), p / (nx_ - 1) % (ny_ - 1), p / ((nx_ - 1) * (ny_ - 1))};
  }
  [[nodiscard]] bool isCorner(Point p) const { return p < corners_; }
  /// The ends of a long edge differ in parity.
  [[nodiscard]] bool isEven(Point p) const {
    const auto c = coordinates(p);
    return (c[0] + c[1] + c[2]) % 2 == 0;
  }

  /// The up to 14 points that share an edge with p, in a fixed order. @return how many
  int neighbours(Point p, std::array<Neighbour, 14>& out) const {
    const auto [i, j, k] = coordinates(p);
    const bool fromCorner = isCorner(p);
    int n = 0;
    const auto add = [&](Point a, Point b, Point c, bool asCorner, bool isLong) {
      if (!(asCorner ? hasCorner(a, b, c) : hasCentre(a, b, c))) return;
      out[static_cast<std::size_t>(n++)] = {asCorner ? corner(a, b, c) : centre(a, b, c), isLong};
    };
    for (const Point d : {-1, 1}) {
      add(i + d, j, k, fromCorner, true);
      add(i, j + d, k, fromCorner, true);
      add(i, j, k + d, fromCorner, true);
    }
    const Point base = fromCorner ? -1 : 0;
    for (Point c = 0; c < 2; ++c) {
      for (Point b = 0; b < 2; ++b) {
        for (Point a = 0; a < 2; ++a) add(i + base + a, j + base + b, k + base + c, !fromCorner, false);
      }
    }
    return n;
  }

  /// Calls visit(corner, corner, centre, centre) for every lattice tetrahedron: first and last two
  /// joined by long edges.
  template <class Visit>
  void forEachTetrahedron(const Visit& visit) const {
    for (Point k = 0; k < nz_; ++k) {
      for (Point j = 0; j < ny_; ++j) {
        for (Point i = 0; i < nx_; ++i) {
          for (int axis = 0; axis < 3; ++axis) {
            const std::array<Point, 3> from{i, j, k};
            std::array<Point, 3> to = from;
            ++to[static_cast<std::size_t>(axis)];
            if (!hasCorner(to[0], to[1], to[2])) continue;
            // The four cubes around the edge, in cyclic order.
            const auto u = static_cast<std::size_t>((axis + 1) % 3);
            const auto v = static_cast<std::size_t>((axis + 2) % 3);
            std::array<std::array<Point, 3>, 4> ring{from, from, from, from};
            --ring[0][u], --ring[0][v];
            --ring[1][v];
            --ring[3][u];
            for (std::size_t r = 0; r < 4; ++r) {
              const auto& x = ring[r];
              const auto& y = ring[(r + 1) % 4];
              if (!hasCentre(x[0], x[1], x[2]) || !hasCentre(y[0], y[1], y[2])) continue;
              visit(corner(i, j, k), corner(to[0], to[1], to[2]), centre(x[0], x[1], x[2]), centre(y[0], y[1], y[2]));
            }
          }
        }
      }
    }
  }

 private:
  Point nx_;
  Point ny_;
  Point nz_;
  Point corners_;
};

double volumeOf(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

/// State of one stuffing: values and positions of lattice points, and tetrahedra as keys.
class Stuffing {
 public:
  Stuffing(const BccLattice& lattice, const std::vector<double>& value, double level, const StuffingLimits& limits,
           const CutShare& cutShare)
      : grid_(lattice), value_(value), position_(value.size()), limits_(limits), cutShare_(cutShare) {
    for (std::size_t p = 0; p < value_.size(); ++p) {
      value_[p] -= level;
      position_[p] = lattice.position(static_cast<Point>(p));
    }
  }

  TetrahedralMesh run() {
    warp();
    grid_.forEachTetrahedron([this](Point a, Point b, Point c, Point d) { fill({a, b, c, d}); });
    return assemble();
  }

 private:
  [[nodiscard]] double value(Point p) const { return value_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] const Vec3& position(Point p) const { return position_[static_cast<std::size_t>(p)]; }

  /// The cut of edge p-q, p < q, as a share from p.
  [[nodiscard]] double shareOf(Point p, Point q) const {
    return cutShare_ ? cutShare_(p, q) : value(p) / (value(p) - value(q));
  }

  /// Moves points with a cut that is too near onto the nearest such cut, in order of the points. A moved point is on
  /// the surface: its edges no longer have cuts.
  void warp() {
    std::array<Neighbour, 14> near;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      if (value_[i] == 0.0) continue;
      const auto p = static_cast<Point>(i);
      const int n = grid_.neighbours(p, near);
      double best = 1e300;
      Vec3 target = Vec3::Zero();
      for (int k = 0; k < n; ++k) {
        const Neighbour& q = near[static_cast<std::size_t>(k)];
        if (!((value_[i] < 0.0 && value(q.point) > 0.0) || (value_[i] > 0.0 && value(q.point) < 0.0))) continue;
        const double share = p < q.point ? shareOf(p, q.point) : 1.0 - shareOf(q.point, p);
        if (!(share < (q.isLong ? limits_.longEdge : limits_.shortEdge))) continue;
        const Vec3 step = share * (position(q.point) - position_[i]);
        const double length2 = step.squaredNorm();
        if (!(length2 < best)) continue;
        best = length2;
        target = position_[i] + step;
      }
      if (best < 1e300) {
        position_[i] = target;
        value_[i] = 0.0;
      }
    }
  }

  static Key cut(Point p, Point q) { return {std::min(p, q), std::max(p, q)}; }

  [[nodiscard]] Vec3 place(const Key& key) const {
    const Vec3& p = position(key.first);
    if (key.first == key.second) return p;
    return p + shareOf(key.first, key.second) * (position(key.second) - p);
  }

  /// Quadrilateral p1, p2 (inside) and their cuts towards m (outside), a piece of the lattice face p1 p2 m. True when
  /// its diagonal runs from p1 to the cut of p2. It ends at the cut of the long edge. With two short edges it starts at
  /// the inside point whose coordinates' sum has the parity of m's: then the two such faces of a tetrahedron get
  /// diagonals that start at different points (with parity of the inside point alone, both start at one, and angles of
  /// 8.6 degrees appear). Both sides of a face decide identically.
  [[nodiscard]] bool diagonalAtFirst(Point p1, Point p2, Point m) const {
    if (grid_.isCorner(p1) == grid_.isCorner(m)) return false;
    if (grid_.isCorner(p2) == grid_.isCorner(m)) return true;
    return grid_.isEven(p1) == grid_.isEven(m);
  }

  void emit(const Key& a, const Key& b, const Key& c, const Key& d) { output_.push_back({a, b, c, d}); }

  /// Prism between triangles (a0, a1, a2) and (b0, b1, b2), each quadrilateral i < j with the diagonal a_i - b_j.
  void emitPrism(const std::array<Key, 3>& a, const std::array<Key, 3>& b) {
    emit(a[0], a[1], a[2], b[2]);
    emit(a[0], a[1], b[1], b[2]);
    emit(a[0], b[0], b[1], b[2]);
  }

  void fill(const std::array<Point, 4>& corner) {
    std::array<Point, 4> in{};
    std::array<Point, 4> out{};
    std::array<Point, 4> on{};
    std::size_t ins = 0;
    std::size_t outs = 0;
    std::size_t ons = 0;
    for (const Point p : corner) {
      if (value(p) < 0.0) {
        in[ins++] = p;
      } else if (value(p) > 0.0) {
        out[outs++] = p;
      } else {
        on[ons++] = p;
      }
    }
    if (ins == 0) return;
    if (outs == 0) {
      emit(cut(corner[0], corner[0]), cut(corner[1], corner[1]), cut(corner[2], corner[2]), cut(corner[3], corner[3]));
    } else if (ins == 1) {
      std::array<Key, 4> key{};
      for (std::size_t i = 0; i < 4; ++i) {
        key[i] = value(corner[i]) > 0.0 ? cut(in[0], corner[i]) : Key{corner[i], corner[i]};
      }
      emit(key[0], key[1], key[2], key[3]);
    } else if (ins == 2 && outs == 1) {
      // A pyramid: the quadrilateral's halves, each with the point on the surface.
      const bool first = diagonalAtFirst(in[0], in[1], out[0]);
      const Point p1 = first ? in[0] : in[1];
      const Point p2 = first ? in[1] : in[0];
      const Key apex{on[0], on[0]};
      emit({p1, p1}, {p2, p2}, cut(p2, out[0]), apex);
      emit({p1, p1}, cut(p2, out[0]), cut(p1, out[0]), apex);
    } else if (ins == 3) {
      fillThree(in, out[0]);
    } else {
      fillTwo(in[0], in[1], out[0], out[1]);
    }
  }

  /// Three inside, one outside: a prism whose columns run from each inside point to its cut.
  void fillThree(const std::array<Point, 4>& in, Point m) {
    std::array<Point, 3> order{in[0], in[1], in[2]};
    for (std::size_t i = 0; i < 2; ++i) {
      if (grid_.isCorner(order[i]) == grid_.isCorner(m)) std::swap(order[i], order[2]);
    }
    if (!diagonalAtFirst(order[0], order[1], m)) std::swap(order[0], order[1]);
    std::array<Key, 3> inside{};
    std::array<Key, 3> cuts{};
    for (std::size_t i = 0; i < 3; ++i) {
      inside[i] = {order[i], order[i]};
      cuts[i] = cut(order[i], m);
    }
    emitPrism(inside, cuts);
  }

  /// Two inside, two outside: a prism with ends (p1 and its two cuts) and (p2 and its two cuts).
  void fillTwo(Point p1, Point p2, Point m1, Point m2) {
    if (grid_.isCorner(p1) == grid_.isCorner(p2)) {
      // All cuts are on short edges. m1 and m2 differ in parity, so that one diagonal starts at p1 and one at p2.
      if (!diagonalAtFirst(p1, p2, m2)) std::swap(m1, m2);
      emitPrism({cut(p1, m1), Key{p1, p1}, cut(p1, m2)}, {cut(p2, m1), Key{p2, p2}, cut(p2, m2)});
    } else {
      // Each inside point has a long edge to one outside point: the diagonals end there, and the surface's diagonal
      // must join these two cuts.
      if (grid_.isCorner(p1) != grid_.isCorner(m1)) std::swap(m1, m2);
      emitPrism({cut(p1, m1), Key{p1, p1}, cut(p1, m2)}, {cut(p2, m1), Key{p2, p2}, cut(p2, m2)});
    }
  }

  [[nodiscard]] TetrahedralMesh assemble() const {
    std::vector<Key> keys;
    keys.reserve(4 * output_.size());
    for (const auto& t : output_) keys.insert(keys.end(), t.begin(), t.end());
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    TetrahedralMesh mesh;
    mesh.vertex.reserve(keys.size());
    for (const Key& key : keys) mesh.vertex.push_back(place(key));
    mesh.tetrahedron.reserve(output_.size());
    for (const auto& t : output_) {
      Index4 v;
      for (int k = 0; k < 4; ++k) {
        const auto found = std::lower_bound(keys.begin(), keys.end(), t[slot(k)]);
        v[k] = static_cast<int>(found - keys.begin());
      }
      const double volume =
          volumeOf(mesh.vertex[slot(v[0])], mesh.vertex[slot(v[1])], mesh.vertex[slot(v[2])], mesh.vertex[slot(v[3])]);
      if (volume < 0.0) std::swap(v[2], v[3]);
      mesh.tetrahedron.push_back(v);
    }
    return mesh;
  }

  Grid grid_;
  std::vector<double> value_;
  std::vector<Vec3> position_;
  StuffingLimits limits_;
  const CutShare& cutShare_;
  std::vector<std::array<Key, 4>> output_;
};

}  // namespace

BccLattice BccLattice::around(const Box& box, double cell) {
  BccLattice lattice;
  lattice.cell = cell;
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  for (int k = 0; k < 3; ++k) {
    const double cells = std::ceil((box.upper[k] - box.lower[k]) / cell) + 2.0;
    lattice.size[k] = static_cast<int>(std::clamp(cells, 2.0, 1e6)) + 1;
    lattice.origin[k] = middle[k] - 0.5 * cell * static_cast<double>(lattice.size[k] - 1);
  }
  return lattice;
}

std::int64_t BccLattice::corners() const {
  return std::int64_t{size[0]} * std::int64_t{size[1]} * std::int64_t{size[2]};
}

std::int64_t BccLattice::points() const {
  return corners() + std::int64_t{size[0] - 1} * std::int64_t{size[1] - 1} * std::int64_t{size[2] - 1};
}

Vec3 BccLattice::position(std::int64_t p) const {
  const std::array<Point, 3> c = Grid(*this).coordinates(p);
  const double shift = p < corners() ? 0.0 : 0.5;
  return {origin[0] + cell * (static_cast<double>(c[0]) + shift),
          origin[1] + cell * (static_cast<double>(c[1]) + shift),
          origin[2] + cell * (static_cast<double>(c[2]) + shift)};
}

TetrahedralMesh stuff(const BccLattice& lattice, const std::vector<double>& value, double level,
                      const StuffingLimits& limits, const CutShare& cut) {
  return Stuffing(lattice, value, level, limits, cut).run();
}

}  // namespace calot

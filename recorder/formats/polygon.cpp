// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace calot::recorder {
namespace {

constexpr double planeRounding = 1e-12;  ///< of the polygon's area: what a fold must exceed

/// The corners of a fan in the plane of two axes, where they run counter-clockwise.
class PlanePolygon {
 public:
  PlanePolygon(const std::vector<Vec3>& vertex, std::span<const Index3> fan) : vertex_(vertex) {
    corner_.assign({fan[0][0], fan[0][1]});
    Vec3 normal = Vec3::Zero();
    for (const Index3& t : fan) {
      corner_.push_back(t[2]);
      normal += at(t[1], t[0]).cross(at(t[2], t[0]));
    }
    int facing = 0;
    normal.cwiseAbs().maxCoeff(&facing);
    first_ = (facing + 1) % 3;
    second_ = (facing + 2) % 3;
    if (normal[facing] < 0.0) std::swap(first_, second_);
    area_ = std::abs(normal[facing]);
  }

  [[nodiscard]] bool folds(std::span<const Index3> fan) const {
    return std::any_of(fan.begin(), fan.end(),
                       [&](const Index3& t) { return turn(t[0], t[1], t[2]) < -planeRounding * area_; });
  }

  /// @return false: the polygon crosses itself
  bool cut(std::span<Index3> triangles) {
    std::vector<std::vector<int>> waiting{corner_};
    std::vector<Index3> made;
    double covered = 0.0;
    while (!waiting.empty()) {
      std::vector<int> ring = std::move(waiting.back());
      waiting.pop_back();
      while (ring.size() >= 3) {
        std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), [&](int a, int b) { return lower(a, b); }),
                    ring.end());
        const std::size_t divides = inTheWay(ring);
        if (divides > 0) {
          std::vector<int> rest(ring.begin() + static_cast<std::ptrdiff_t>(divides), ring.end());
          rest.push_back(ring[0]);
          waiting.push_back(std::move(rest));
          ring.resize(divides + 1);
          continue;
        }
        made.emplace_back(ring.back(), ring[0], ring[1]);
        covered += std::abs(turn(ring.back(), ring[0], ring[1]));
        ring.erase(ring.begin());
      }
    }
    if (made.size() != triangles.size() || !(covered <= (1.0 + 1e-9) * area_)) return false;
    std::copy(made.begin(), made.end(), triangles.begin());
    return true;
  }

 private:
  [[nodiscard]] Vec3 at(int v, int from) const { return vertex_[slotOf(v)] - vertex_[slotOf(from)]; }
  static std::size_t slotOf(int i) { return static_cast<std::size_t>(i); }

  /// Twice the area of a triangle, positive where it turns left.
  [[nodiscard]] double turn(int a, int b, int c) const {
    const Vec3 u = at(b, a), v = at(c, a);
    return u[first_] * v[second_] - u[second_] * v[first_];
  }

  [[nodiscard]] bool lower(int a, int b) const {
    const Vec3 &p = vertex_[slotOf(a)], &q = vertex_[slotOf(b)];
    return p[first_] != q[first_] ? p[first_] < q[first_] : p[second_] < q[second_];
  }

  /// Does the line from corner i of the ring to the vertex `to` start inside the polygon?
  [[nodiscard]] bool seesInside(const std::vector<int>& ring, std::size_t i, int to) const {
    const int before = ring[i - 1], here = ring[i], after = ring[(i + 1) % ring.size()];
    if (turn(before, here, after) >= 0.0) return turn(here, to, before) > 0.0 && turn(to, here, after) > 0.0;
    return turn(here, to, after) < 0.0 || turn(to, here, before) < 0.0;
  }

  [[nodiscard]] bool samePlace(int a, int b) const { return !lower(a, b) && !lower(b, a); }

  /// The corner of the ring in the triangle of the last, first and second corners, or on its sides, that is farthest
  /// from the line that would cut the first one off; 0 for none.
  [[nodiscard]] std::size_t inTheWay(const std::vector<int>& ring) const {
    const int before = ring.back(), tip = ring[0], after = ring[1];
    const bool flat = !(turn(before, tip, after) > 0.0);
    std::size_t found = 0;
    double farthest = 0.0;
    bool sees = false;
    for (std::size_t i = 2; i + 1 < ring.size(); ++i) {
      const double distance = turn(after, before, ring[i]);
      if (distance < farthest || (flat && distance == 0.0) || turn(before, tip, ring[i]) < 0.0 ||
          turn(tip, after, ring[i]) < 0.0 || samePlace(tip, ring[i]) || samePlace(before, ring[i]) ||
          samePlace(after, ring[i])) {
        continue;
      }
      // A bridge has two corners at each end: the one is taken that the tip is seen from.
      const bool better = seesInside(ring, i, tip);
      if (found > 0 && distance == farthest && (sees || !better)) continue;
      found = i;
      farthest = distance;
      sees = better;
    }
    return found;
  }

  const std::vector<Vec3>& vertex_;
  std::vector<int> corner_;
  int first_ = 0, second_ = 1;  ///< axes of the plane
  double area_ = 0.0;           ///< twice the polygon's
};

}  // namespace

bool fanFolds(const std::vector<Vec3>& vertex, std::span<const Index3> fan) {
  return fan.size() > 1 && PlanePolygon(vertex, fan).folds(fan);
}

PolygonCut cutPolygon(const std::vector<Vec3>& vertex, std::span<Index3> fan) {
  if (!fanFolds(vertex, fan)) return PolygonCut::fan;
  return PlanePolygon(vertex, fan).cut(fan) ? PolygonCut::concave : PolygonCut::crossing;
}

}  // namespace calot::recorder

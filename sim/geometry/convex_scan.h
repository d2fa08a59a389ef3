// SPDX-License-Identifier: GPL-3.0-or-later
// Lattice points of a convex set, row by row.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "sim/math/linear.h"

namespace calot {

/// A convex set as an intersection of half-spaces, in lattice coordinates (nodes are integers). Rows run along one
/// axis: half-spaces bound a row from below or above, or contain or exclude it entirely.
class ConvexScan {
 public:
  static constexpr std::size_t capacity = 96;  ///< further half-spaces are ignored, which only enlarges the set
  static constexpr double slack = 1e-6;        ///< by which each half-space is enlarged (cells)

  /// @param axis direction of the rows, ideally that in which the set is longest
  /// @param nodes of the lattice along each axis
  ConvexScan(int axis, const Index3& nodes) : w_(axis), u_((axis + 1) % 3), v_((axis + 2) % 3), nodes_(nodes) {}

  /// Adds {p: normal . (p - at) >= 0}. @param normal of unit length
  void add(const Vec3& normal, const Vec3& at) { add(normal, normal.dot(at)); }
  /// Adds {p: normal . p >= offset}.
  void add(const Vec3& normal, double offset) {
    if (count_ == capacity) return;
    Plane& p = plane_[count_++];
    p.u = normal[u_];
    p.v = normal[v_];
    p.offset = offset - slack;
    const double along = normal[w_];
    // Rows nearly parallel to the plane: their height changes by less than the slack over the lattice.
    p.kind = along > 1e-9 ? 1 : (along < -1e-9 ? -1 : 0);
    p.inverse = p.kind == 0 ? 0.0 : 1.0 / along;
  }

  /// Calls visit(n) for each lattice point in the box that lies in all half-spaces.
  template <class Visit>
  void run(const Box& box, Visit&& visit) const {
    Index3 from;
    Index3 to;
    for (int a = 0; a < 3; ++a) {
      const double last = static_cast<double>(nodes_[a] - 1);
      from[a] = up(std::min(notNegative(box.lower[a] - slack), last + 1.0));
      to[a] = static_cast<int>(std::clamp(box.upper[a] + slack, -1.0, last) + 1.0) - 1;
    }
    Index3 n;
    for (n[v_] = from[v_]; n[v_] <= to[v_]; ++n[v_]) {
      for (n[u_] = from[u_]; n[u_] <= to[u_]; ++n[u_]) {
        double low = from[w_];
        double high = to[w_];
        if (!row(n[u_], n[v_], low, high)) continue;
        const int last = static_cast<int>(high + 1.0) - 1;
        for (n[w_] = up(low); n[w_] <= last; ++n[w_]) visit(n);
      }
    }
  }

 private:
  struct Plane {
    double u = 0.0;
    double v = 0.0;
    double offset = 0.0;
    double inverse = 0.0;
    int kind = 0;
  };

  /// Smallest integer not below x. @pre x >= 0
  static int up(double x) {
    const int i = static_cast<int>(x);
    return i + (static_cast<double>(i) < x ? 1 : 0);
  }

  /// Intersects [low, high] (both within the lattice) with the half-spaces.
  bool row(double u, double v, double& low, double& high) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Plane& p = plane_[i];
      const double remainder = p.offset - (p.u * u + p.v * v);
      if (p.kind > 0) {
        low = std::max(low, remainder * p.inverse);
      } else if (p.kind < 0) {
        high = std::min(high, remainder * p.inverse);
      } else if (remainder > 0.0) {
        return false;
      }
      if (low > high) return false;
    }
    return true;
  }

  int w_;
  int u_;
  int v_;
  Index3 nodes_;
  std::array<Plane, capacity> plane_;
  std::size_t count_ = 0;
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit shapes: functions of a point, negative inside, roughly a distance near zero. Only + - * / and sqrt, so that
// the organs' files come out the same on every machine. Smooth unions after Quilez, "Smooth minimum" (2013).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/math/linear.h"

namespace calot::organs {

/// Minimum rounded over a width k: at most k / 4 below the sharp one.
inline double smoothMin(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

/// Maximum rounded over a width k: at most k / 4 above the sharp one.
inline double smoothMax(double a, double b, double k) { return -smoothMin(-a, -b, k); }

/// A bump of height 1 at 0 and 0 from |x| = 1 on, with a continuous second derivative.
inline double bump(double x) {
  const double h = std::max(1.0 - x * x, 0.0);
  return h * h * h;
}

/// Rises from 0 at x <= 0 to 1 at x >= 1.
inline double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Ellipsoid with semi-axes r around c, its axes turned by the rows of `axes`.
inline double ellipsoid(const Vec3& p, const Vec3& c, const Vec3& r, const Mat3& axes) {
  const Vec3 q = axes * (p - c);
  const double k0 = q.cwiseQuotient(r).norm();
  const double k1 = q.cwiseQuotient(r.cwiseProduct(r)).norm();
  return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -r.minCoeff();
}

/// A ball of changing radius swept along a smooth curve (Catmull-Rom through the knots).
class SweptBall {
 public:
  struct Knot {
    Vec3 centre;
    double radius;
  };

  /// @pre at least two knots
  explicit SweptBall(const std::vector<Knot>& knots) {
    constexpr int pieces = 16;
    const auto knot = [&knots](std::ptrdiff_t i) {
      return knots[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, std::ssize(knots) - 1))];
    };
    for (std::ptrdiff_t i = 0; i + 1 < std::ssize(knots); ++i) {
      for (int s = 0; s < pieces; ++s) {
        const double t = static_cast<double>(s) / pieces;
        const double t2 = t * t;
        const double t3 = t2 * t;
        const std::array<double, 4> w{0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
                                      0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
        Knot k{Vec3::Zero(), 0.0};
        for (std::size_t j = 0; j < 4; ++j) {
          const Knot from = knot(i + static_cast<std::ptrdiff_t>(j) - 1);
          k.centre += w[j] * from.centre;
          k.radius += w[j] * from.radius;
        }
        sample_.push_back(k);
      }
    }
    sample_.push_back(knots.back());
  }

  [[nodiscard]] double operator()(const Vec3& p) const {
    double least = 1e300;
    for (std::size_t i = 0; i + 1 < sample_.size(); ++i) {
      const Knot& a = sample_[i];
      const Knot& b = sample_[i + 1];
      const Vec3 ab = b.centre - a.centre;
      const double t = std::clamp(ab.dot(p - a.centre) / ab.squaredNorm(), 0.0, 1.0);
      const double d = (p - a.centre - t * ab).norm() - (a.radius + t * (b.radius - a.radius));
      least = std::min(least, d);
    }
    return least;
  }

  /// Length of the curve with the first and the last ball's radius at its ends (m).
  [[nodiscard]] double length() const {
    double sum = sample_.front().radius + sample_.back().radius;
    for (std::size_t i = 0; i + 1 < sample_.size(); ++i) sum += (sample_[i + 1].centre - sample_[i].centre).norm();
    return sum;
  }

 private:
  std::vector<Knot> sample_;
};

}  // namespace calot::organs

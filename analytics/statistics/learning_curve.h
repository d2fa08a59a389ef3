// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// A figure over the number x >= 1 of the attempt, a - b / x: towards the plateau a, from below (b > 0) or from above
/// (b < 0). It is the power law of practice a - b x^-c with c = 1.
struct LearningCurve {
  double plateau = 0.0;                       ///< a, the figure's unit
  double gap = 0.0;                           ///< b: what is missing at x = 1
  double plateauError = 0.0, gapError = 0.0;  ///< standard errors, from s^2 (X'X)^-1
  double residualSumOfSquares = 0.0;
  double sigma = 0.0;       ///< sqrt(residualSumOfSquares / freedom)
  double covariance = 0.0;  ///< of plateau and gap
  std::size_t freedom = 0;  ///< values - 2

  [[nodiscard]] double at(double x) const { return plateau - gap / x; }
};

/// Least squares; the curve is linear in a and b. No answer for x that is not positive or not finite, fewer than two
/// distinct x or than three values, and values all equal.
Expected<LearningCurve> fitLearningCurve(std::span<const double> x, std::span<const double> y);

/// Where the curve itself lies at x, by Student's t: a - b / x is linear in a and b, so its variance is
/// Var a - 2 Cov(a, b) / x + Var b / x^2 (Draper and Smith 1998, 1.4).
/// @pre x > 0, 0 < level < 1, curve.freedom > 0
Interval bandOf(const LearningCurve& curve, double x, double level = 0.95);

}  // namespace calot::analytics

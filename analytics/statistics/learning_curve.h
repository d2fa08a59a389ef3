// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

enum class CurveShape : std::uint8_t {
  inverse,     ///< a - b / x
  power,       ///< a - b x^-c
  exponential  ///< a - b exp(-c x)
};

/// A figure over the number x >= 1 of the attempt: towards the plateau a, from below (b > 0) or from above (b < 0).
struct LearningCurve {
  CurveShape shape = CurveShape::inverse;
  double plateau = 0.0;                       ///< a, the figure's unit
  double gap = 0.0;                           ///< b: for inverse and power what is missing at x = 1
  double rate = 1.0;                          ///< c > 0; 1 for inverse
  double plateauError = 0.0, gapError = 0.0;  ///< standard errors, from s^2 (J'J)^-1 at the minimum
  std::optional<double> rateError;            ///< none for inverse
  double residualSumOfSquares = 0.0;
  double sigma = 0.0;       ///< sqrt(residualSumOfSquares / (values - parameters))
  double covariance = 0.0;  ///< of plateau and gap; of `inverse` alone
  std::size_t freedom = 0;  ///< values - parameters

  [[nodiscard]] double at(double x) const;
};

/// Least squares. For a given c the curve is linear in a and b, so the sum of squares is minimised over c alone
/// (variable projection: Golub and Pereyra 1973): the best of a grid over ln c, Brent's method around it, then
/// Gauss-Newton steps for the last digits. No answer for x that is not positive or not finite, fewer distinct x than
/// parameters or no more values than parameters, values all equal, and where the sum of squares falls to the end of the
/// grid: no plateau in sight (c to 0: a straight line, or for the power a logarithm) or all change over after the first
/// attempt (c to infinity).
Expected<LearningCurve> fitLearningCurve(CurveShape shape, std::span<const double> x, std::span<const double> y);

/// Where the curve itself lies at x, by Student's t: a - b / x is linear in a and b, so its variance is
/// Var a - 2 Cov(a, b) / x + Var b / x^2 (Draper and Smith 1998, 1.4). None for the other shapes.
/// @pre x > 0, 0 < level < 1
Expected<Interval> bandOf(const LearningCurve& curve, double x, double level = 0.95);

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of two methods that measured the same people: limits of agreement, Deming regression.
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// Agreement of two methods that measured the same.
struct BlandAltman {
  std::size_t pairs = 0;
  double bias = 0.0;       ///< mean of first less second
  double deviation = 0.0;  ///< of the differences
  double lower = 0.0, upper = 0.0;
  Interval biasInterval, lowerInterval, upperInterval;
};

/// Limits of agreement bias -+ 1.96 s with Student's intervals of n - 1 degrees of freedom: the bias has the variance
/// s^2 / n, a limit s^2 (1 / n + 1.96^2 / (2 (n - 1))) (Bland and Altman 1999, Stat. Methods Med. Res. 8:135). Assumes
/// normal differences that do not depend on the size of what is measured, one pair of each participant. No answer for
/// lengths that differ, fewer than three pairs, values not finite, or differences all equal. @pre 0 < level < 1.
Expected<BlandAltman> blandAltman(std::span<const double> first, std::span<const double> second, double level = 0.95);

/// y = intercept + slope x, both measured with error.
struct DemingRegression {
  std::size_t pairs = 0;
  double intercept = 0.0, slope = 1.0;
  double interceptError = 0.0, slopeError = 0.0;  ///< jackknife
  Interval interceptInterval, slopeInterval;
};

/// With d the variance of y's errors over that of x's and S the sums of squares and products about the means:
///   slope = (Syy - d Sxx + sqrt((Syy - d Sxx)^2 + 4 d Sxy^2)) / (2 Sxy)
/// (Deming 1943). Errors by the jackknife: the deviation of the pseudo-values n b - (n - 1) b_i over the root of n;
/// intervals by Student's t with n - 2 degrees of freedom (Linnet 1993, Clin. Chem. 39:424). No answer for lengths that
/// differ, fewer than four pairs, values not finite, or a slope that is not determined, also without one pair.
/// @pre errorRatio > 0, 0 < level < 1.
Expected<DemingRegression> demingRegression(std::span<const double> x, std::span<const double> y,
                                            double errorRatio = 1.0, double level = 0.95);

}  // namespace calot::analytics

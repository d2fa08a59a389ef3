// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/contrasting_groups.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

struct BorderlineRegression {
  std::size_t rated = 0;
  double cut = 0.0;  ///< score of an attempt rated at the borderline mark, by the line
  Interval interval;
  double intercept = 0.0, slope = 0.0;
  double r = 0.0;                 ///< correlation of rating and score
  std::size_t atOrBelowMark = 0;  ///< attempts rated at the mark or worse
};

/// Pass mark from global ratings (borderline regression: Kramer et al. 2003, Med. Educ. 37:132): score = a + b rating
/// by least squares, cut = a + b mark. Interval of the line's mean there: cut -+ t s sqrt(1 / n + (mark - mean)^2 /
/// Sxx), n - 2 degrees of freedom. Higher ratings are better. No answer for lengths that differ, fewer than four
/// attempts, values not finite, ratings all equal or on one side of the mark, or a line that rises where it should
/// fall.
/// @pre 0 < level < 1.
Expected<BorderlineRegression> borderlineRegression(std::span<const double> ratings, std::span<const double> scores,
                                                    double mark, Better better, double level = 0.95);

}  // namespace calot::analytics

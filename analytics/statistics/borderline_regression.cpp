// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/borderline_regression.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/least_squares.h"

namespace calot::analytics {

Expected<BorderlineRegression> borderlineRegression(std::span<const double> ratings, std::span<const double> scores,
                                                    double mark, Better better, double level) {
  using Result = Expected<BorderlineRegression>;
  if (ratings.size() != scores.size()) return Result::none("the two variables have different lengths");
  if (ratings.size() < 4) return Result::none("fewer than four rated attempts");
  const std::vector<double> x(ratings.begin(), ratings.end());
  const std::vector<double> constant(x.size(), 1.0);
  const Expected<double> centre = mean(x);
  if (!centre) return Result::none(centre.reason());
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  if (*least == *most) return Result::none("all ratings are equal");
  if (mark < *least || mark > *most) return Result::none("all ratings are on one side of the borderline mark");
  const Expected<LeastSquares> fit = leastSquares({constant, x}, scores);
  if (!fit) return Result::none(fit.reason());
  BorderlineRegression result;
  result.rated = x.size();
  result.intercept = fit->coefficients[0];
  result.slope = fit->coefficients[1];
  if (!(better == Better::higher ? result.slope > 0.0 : result.slope < 0.0))
    return Result::none("attempts with better ratings do not have better values");
  result.cut = result.intercept + result.slope * mark;
  double squares = 0.0, total = 0.0;
  const double middle = *mean(scores);
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - *centre) * (x[i] - *centre);
    total += (scores[i] - middle) * (scores[i] - middle);
    if (x[i] <= mark) ++result.atOrBelowMark;
  }
  result.r = result.slope * std::sqrt(squares / total);
  const double apart = mark - *centre;
  const double error = fit->sigma * std::sqrt(1.0 / static_cast<double>(x.size()) + apart * apart / squares);
  const double half = studentQuantile(0.5 + level / 2.0, fit->df) * error;
  result.interval = {result.cut - half, result.cut + half, level, "Student's t, mean at the mark"};
  return result;
}

}  // namespace calot::analytics

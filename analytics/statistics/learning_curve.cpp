// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/learning_curve.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {

Expected<LearningCurve> fitLearningCurve(std::span<const double> x, std::span<const double> y) {
  using Result = Expected<LearningCurve>;
  if (x.size() != y.size()) return Result::none("attempts and values have different lengths");
  if (!allFinite(x) || !allFinite(y)) return Result::none("a value is not finite");
  if (!std::all_of(x.begin(), x.end(), [](double v) { return v > 0.0; }))
    return Result::none("an attempt's number is not positive");
  constexpr std::size_t parameters = 2;
  if (std::set<double>(x.begin(), x.end()).size() < parameters || y.size() <= parameters)
    return Result::none("too few attempts for the curve");
  if (std::all_of(y.begin(), y.end(), [&](double v) { return v == y.front(); }))
    return Result::none("all values are equal");
  std::vector<std::vector<double>> columns(2, std::vector<double>(x.size(), 1.0));
  for (std::size_t i = 0; i < x.size(); ++i) columns[1][i] = -1.0 / x[i];
  const Expected<LeastSquares> fit = leastSquares(columns, y);
  if (!fit) return Result::none(fit.reason());
  const std::vector<double> errors = fit->standardErrors();
  LearningCurve curve;
  curve.plateau = fit->coefficients[0];
  curve.gap = fit->coefficients[1];
  curve.plateauError = errors[0];
  curve.gapError = errors[1];
  curve.residualSumOfSquares = fit->residualSumOfSquares;
  curve.sigma = fit->sigma;
  curve.covariance = fit->sigma * fit->sigma * fit->unscaled[1];
  curve.freedom = y.size() - parameters;
  return curve;
}

Interval bandOf(const LearningCurve& curve, double x, double level) {
  const double variance =
      curve.plateauError * curve.plateauError - 2.0 * curve.covariance / x + curve.gapError * curve.gapError / (x * x);
  const double half =
      studentQuantile(0.5 + 0.5 * level, static_cast<double>(curve.freedom)) * std::sqrt(std::max(0.0, variance));
  return Interval{curve.at(x) - half, curve.at(x) + half, level, "Student's t of a linear fit, pointwise"};
}

}  // namespace calot::analytics

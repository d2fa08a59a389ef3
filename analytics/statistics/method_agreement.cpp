// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/method_agreement.h"

#include <cmath>
#include <optional>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

Expected<BlandAltman> blandAltman(std::span<const double> first, std::span<const double> second, double level) {
  using Result = Expected<BlandAltman>;
  if (first.size() != second.size()) return Result::none("the two variables have different lengths");
  if (first.size() < 3) return Result::none("fewer than three pairs");
  if (!allFinite(first) || !allFinite(second)) return Result::none("a value is not finite");
  std::vector<double> differences;
  for (std::size_t i = 0; i < first.size(); ++i) differences.push_back(first[i] - second[i]);
  BlandAltman result;
  result.pairs = first.size();
  result.bias = *mean(differences);
  result.deviation = *standardDeviation(differences);
  if (!(result.deviation > 0.0)) return Result::none("all differences are equal");
  const double n = static_cast<double>(result.pairs), z = normalQuantile(0.975);
  result.lower = result.bias - z * result.deviation;
  result.upper = result.bias + z * result.deviation;
  const double t = studentQuantile(0.5 + level / 2.0, n - 1.0);
  const auto around = [&](double value, double variance) {
    const double half = t * result.deviation * std::sqrt(variance);
    return Interval{value - half, value + half, level, "Student's t"};
  };
  const double ofLimit = 1.0 / n + z * z / (2.0 * (n - 1.0));
  result.biasInterval = around(result.bias, 1.0 / n);
  result.lowerInterval = around(result.lower, ofLimit);
  result.upperInterval = around(result.upper, ofLimit);
  return result;
}

namespace {

struct DemingLine {
  double intercept = 0.0, slope = 1.0;
};

std::optional<DemingLine> demingLine(std::span<const double> x, std::span<const double> y, double errorRatio) {
  const double mx = *mean(x), my = *mean(y);
  double sxx = 0.0, syy = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sxx += (x[i] - mx) * (x[i] - mx);
    syy += (y[i] - my) * (y[i] - my);
    sxy += (x[i] - mx) * (y[i] - my);
  }
  if (sxy == 0.0) return std::nullopt;
  const double apart = syy - errorRatio * sxx, root = std::hypot(apart, 2.0 * std::sqrt(errorRatio) * sxy);
  // Of the two forms the one without cancellation.
  const double slope = apart >= 0.0 ? (apart + root) / (2.0 * sxy) : 2.0 * errorRatio * sxy / (root - apart);
  if (!std::isfinite(slope)) return std::nullopt;
  return DemingLine{my - slope * mx, slope};
}

}  // namespace

Expected<DemingRegression> demingRegression(std::span<const double> x, std::span<const double> y, double errorRatio,
                                            double level) {
  using Result = Expected<DemingRegression>;
  if (x.size() != y.size()) return Result::none("the two variables have different lengths");
  if (x.size() < 4) return Result::none("fewer than four pairs");
  if (!allFinite(x) || !allFinite(y)) return Result::none("a value is not finite");
  const std::optional<DemingLine> whole = demingLine(x, y, errorRatio);
  if (!whole) return Result::none("the slope is not determined");
  const double n = static_cast<double>(x.size());
  std::vector<double> slopes, intercepts;
  for (std::size_t out = 0; out < x.size(); ++out) {
    std::vector<double> withoutX, withoutY;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (i == out) continue;
      withoutX.push_back(x[i]);
      withoutY.push_back(y[i]);
    }
    const std::optional<DemingLine> line = demingLine(withoutX, withoutY, errorRatio);
    if (!line) return Result::none("one pair alone determines the slope");
    slopes.push_back(n * whole->slope - (n - 1.0) * line->slope);
    intercepts.push_back(n * whole->intercept - (n - 1.0) * line->intercept);
  }
  DemingRegression result;
  result.pairs = x.size();
  result.slope = whole->slope;
  result.intercept = whole->intercept;
  result.slopeError = *standardDeviation(slopes) / std::sqrt(n);
  result.interceptError = *standardDeviation(intercepts) / std::sqrt(n);
  const double t = studentQuantile(0.5 + level / 2.0, n - 2.0);
  const auto around = [&](double value, double error) {
    return Interval{value - t * error, value + t * error, level, "jackknife, Student's t"};
  };
  result.slopeInterval = around(result.slope, result.slopeError);
  result.interceptInterval = around(result.intercept, result.interceptError);
  return result;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/bland_altman.h"

#include <cmath>
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

}  // namespace calot::analytics

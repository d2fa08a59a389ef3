// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/descriptive.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

constexpr const char* noValues = "no values";
constexpr const char* notFinite = "a value is not finite";

}  // namespace

Expected<double> mean(std::span<const double> values) {
  if (values.empty()) return Expected<double>::none(noValues);
  if (!allFinite(values)) return Expected<double>::none(notFinite);
  double sum = 0.0;
  for (const double v : values) sum += v;
  const double n = static_cast<double>(values.size());
  const double first = sum / n;
  // One correction step removes the rounding error of the sum if values are large and close together.
  double rest = 0.0;
  for (const double v : values) rest += v - first;
  return first + rest / n;
}

Expected<double> standardDeviation(std::span<const double> values) {
  if (values.size() < 2) return Expected<double>::none(values.empty() ? noValues : "one value has no spread");
  const Expected<double> centre = mean(values);
  if (!centre) return centre;
  double sum = 0.0;
  for (const double v : values) sum += (v - *centre) * (v - *centre);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double quantileOfSorted(std::span<const double> sorted, double p) {
  assert(!sorted.empty() && p >= 0.0 && p <= 1.0);
  const double h = static_cast<double>(sorted.size() - 1) * p;
  const auto below = static_cast<std::size_t>(std::floor(h));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (h - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

Expected<double> quantile(std::span<const double> values, double p) {
  if (values.empty()) return Expected<double>::none(noValues);
  if (!allFinite(values)) return Expected<double>::none(notFinite);
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return quantileOfSorted(sorted, p);
}

Expected<double> median(std::span<const double> values) { return quantile(values, 0.5); }

}  // namespace calot::analytics

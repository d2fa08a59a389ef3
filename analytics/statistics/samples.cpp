// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/samples.h"

#include <algorithm>
#include <cmath>

namespace calot::analytics {

bool allFinite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::string twoGroupObjection(std::span<const double> x, std::span<const double> y) {
  if (x.empty() && y.empty()) return "both groups are empty";
  if (x.empty()) return "the first group is empty";
  if (y.empty()) return "the second group is empty";
  if (!allFinite(x) || !allFinite(y)) return "a value is not finite";
  return {};
}

std::vector<double> pooled(std::span<const double> x, std::span<const double> y) {
  std::vector<double> all(x.begin(), x.end());
  all.insert(all.end(), y.begin(), y.end());
  return all;
}

double tieTerm(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0.0;
  for (std::size_t first = 0; first < sorted.size();) {
    std::size_t next = first;
    while (next < sorted.size() && sorted[next] == sorted[first]) ++next;
    const double t = static_cast<double>(next - first);
    sum += t * t * t - t;
    first = next;
  }
  return sum;
}

}  // namespace calot::analytics

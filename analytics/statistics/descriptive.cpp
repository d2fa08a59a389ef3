// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/descriptive.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

namespace calot::analytics {
namespace {

constexpr const char* noValues = "no values";
constexpr const char* notFinite = "a value is not finite";

}  // namespace

Expected<double> mean(std::span<const double> values) {
  if (values.empty()) return NoResult{noValues};
  if (!allFinite(values)) return NoResult{notFinite};
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
  if (values.size() < 2) return NoResult{values.empty() ? noValues : "one value has no spread"};
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
  if (values.empty()) return NoResult{noValues};
  if (!allFinite(values)) return NoResult{notFinite};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return quantileOfSorted(sorted, p);
}

Expected<double> median(std::span<const double> values) { return quantile(values, 0.5); }

Summary summaryOf(std::span<const double> values) {
  return {values.size(),
          mean(values).optional(),
          standardDeviation(values).optional(),
          median(values).optional(),
          quantile(values, 0.25).optional(),
          quantile(values, 0.75).optional()};
}

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

Expected<std::vector<ParticipantValue>> onePerParticipant(std::span<const RepeatedValue> values, AttemptRule rule) {
  if (values.empty()) return NoResult{"no values"};
  std::map<std::size_t, std::vector<RepeatedValue>> attempts;
  std::set<std::pair<std::size_t, double>> orders;
  for (const RepeatedValue& v : values) {
    if (!std::isfinite(v.value) || !std::isfinite(v.order)) return NoResult{"a value is not finite"};
    if (rule == AttemptRule::first && !orders.insert({v.participant, v.order}).second)
      return NoResult{"two attempts of a participant have one order"};
    attempts[v.participant].push_back(v);
  }
  std::vector<ParticipantValue> result;
  for (const auto& [participant, list] : attempts) {
    ParticipantValue one{participant, 0.0, list.size()};
    if (rule == AttemptRule::first) {
      one.value = std::min_element(list.begin(), list.end(), [](const RepeatedValue& a, const RepeatedValue& b) {
                    return a.order < b.order;
                  })->value;
    } else {
      std::vector<double> figures;
      for (const RepeatedValue& v : list) figures.push_back(v.value);
      one.value = *mean(figures);
    }
    result.push_back(one);
  }
  return result;
}

}  // namespace calot::analytics

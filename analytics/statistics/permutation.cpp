// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/permutation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/random_stream.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

/// C(n, k), or `limit` + 1 where it is larger.
std::uint64_t choices(std::uint64_t n, std::uint64_t k, std::uint64_t limit) {
  k = std::min(k, n - k);
  double count = 1.0;
  for (std::uint64_t i = 1; i <= k; ++i) {
    count = count * static_cast<double>(n - k + i) / static_cast<double>(i);
    if (count > static_cast<double>(limit) + 0.5) return limit + 1;
  }
  return static_cast<std::uint64_t>(std::llround(count));
}

/// Counts the choices of `left` more values from `first` on whose total with `sum` deviates by at least `distance`.
struct Walk {
  std::span<const double> values;
  double distance = 0.0;
  std::uint64_t hits = 0, all = 0;
  void from(std::size_t first, std::size_t left, double sum) {
    if (left == 0) {
      ++all;
      if (std::abs(sum) >= distance) ++hits;
      return;
    }
    for (std::size_t i = first; i + left <= values.size(); ++i) from(i + 1, left - 1, sum + values[i]);
  }
};

}  // namespace

Expected<PermutationTest> permutationTest(std::span<const double> x, std::span<const double> y,
                                          const PermutationOptions& options) {
  using Result = Expected<PermutationTest>;
  assert(options.draws > 0);
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Result::none(reason);
  std::vector<double> values = pooled(x, y);
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); }))
    return Result::none("all values are equal");
  PermutationTest result;
  result.difference = *mean(x) - *mean(y);
  // About the pooled mean, the expected sum of a group is zero, and the groups' sums differ only in sign.
  const double centre = *mean(values);
  double scale = 0.0, observed = 0.0;
  for (double& v : values) scale += std::abs(v -= centre);
  for (std::size_t i = 0; i < x.size(); ++i) observed += values[i];
  const std::size_t n = std::min(x.size(), y.size());
  Walk walk{values, std::abs(observed) - 1e-11 * scale};
  if (choices(values.size(), n, options.maxAssignments) <= options.maxAssignments) {
    walk.from(0, n, 0.0);
    result.exact = true;
    result.assignments = walk.all;
    result.p = static_cast<double>(walk.hits) / static_cast<double>(walk.all);
    return result;
  }
  RandomStream random(options.seed);
  for (std::uint64_t draw = 0; draw < options.draws; ++draw) {
    // The first n positions of a shuffle.
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      std::swap(values[i], values[i + static_cast<std::size_t>(random.below(values.size() - i))]);
      sum += values[i];
    }
    if (std::abs(sum) >= walk.distance) ++walk.hits;
  }
  result.assignments = options.draws;
  result.seed = options.seed;
  result.p = static_cast<double>(walk.hits + 1) / static_cast<double>(options.draws + 1);
  return result;
}

}  // namespace calot::analytics

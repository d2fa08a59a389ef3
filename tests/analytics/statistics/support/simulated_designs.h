// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of designs whose intervals the coverage table holds: what is drawn comes in, the rest by a seed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/reliability.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/standard_setting.h"

namespace calot::analytics::simulated {

using Values = std::vector<double>;

/// Upper limit of agreement of two methods with these errors.
inline Expected<Interval> upperLimit(const Values& x, const Values& y) {
  const auto r = blandAltman(x, y);
  return r ? Expected<Interval>(r->upperInterval) : NoResult{r.reason()};
}

/// Slope of two methods that measure x with normal errors of deviation 1/2.
inline Expected<Interval> demingSlope(const Values& x, std::uint64_t seed) {
  RandomStream random(~seed);
  Values first, second;
  for (const double v : x) {
    first.push_back(v + 0.5 * random.normal());
    second.push_back(v + 0.5 * random.normal());
  }
  const auto r = demingRegression(first, second);
  return r ? Expected<Interval>(r->slopeInterval) : NoResult{r.reason()};
}

/// Smallest detectable change from three attempts each, errors of deviation 1: normal or exponential.
inline Expected<Interval> detectableChange(const Values& x, bool normal, std::uint64_t seed) {
  RandomStream random(~seed);
  std::vector<RepeatedValue> values;
  for (std::size_t person = 0; person < x.size(); ++person) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      const double error = normal ? random.normal() : -std::log(random.uniform());
      values.push_back({person, static_cast<double>(attempt), x[person] + error});
    }
  }
  const auto r = measurementError(values);
  return r ? Expected<Interval>(r->sdcInterval) : NoResult{r.reason()};
}

/// Cut at mark 2 of ratings 1 to 5, scores 2 rating + x.
inline Expected<Interval> borderlineCut(const Values& x, std::uint64_t seed) {
  RandomStream random(~seed);
  Values ratings, scores;
  for (const double error : x) {
    ratings.push_back(static_cast<double>(1 + random.below(5)));
    scores.push_back(2.0 * ratings.back() + error);
  }
  const auto r = borderlineRegression(ratings, scores, 2.0, Better::higher);
  return r ? Expected<Interval>(r->interval) : NoResult{r.reason()};
}

/// Spearman's correlation of x and r x + sqrt(1 - r^2) y.
inline Expected<Interval> rankCorrelation(const Values& x, const Values& y, double r) {
  Values mixed;
  for (std::size_t i = 0; i < x.size(); ++i) mixed.push_back(r * x[i] + std::sqrt(1.0 - r * r) * y[i]);
  const auto rho = spearman(x, mixed);
  return rho ? spearmanInterval(rho->rho, x.size()) : NoResult{rho.reason()};
}

}  // namespace calot::analytics::simulated

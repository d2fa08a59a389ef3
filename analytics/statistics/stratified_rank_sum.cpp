// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/stratified_rank_sum.h"

#include <cmath>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/samples.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

Expected<StratifiedRankSum> stratifiedRankSum(std::span<const Stratum> strata) {
  using Result = Expected<StratifiedRankSum>;
  StratifiedRankSum result;
  double sum = 0.0, variance = 0.0, wins = 0.0, weights = 0.0;
  for (const Stratum& s : strata) {
    if (!allFinite(s.x) || !allFinite(s.y)) return Result::none("a value is not finite");
    const double nx = static_cast<double>(s.x.size()), ny = static_cast<double>(s.y.size()), n = nx + ny;
    const double ties = tieTerm(pooled(s.x, s.y));
    if (s.x.empty() || s.y.empty() || ties == n * n * n - n) {
      ++result.left;
      continue;
    }
    ++result.strata;
    const double area = superiority(s.x, s.y)->a, weight = 1.0 / (n + 1.0);
    sum += weight * nx * ny * (area - 0.5);
    variance += weight * weight * nx * ny / 12.0 * (n + 1.0 - ties / (n * (n - 1.0)));
    wins += weight * nx * ny * area;
    weights += weight * nx * ny;
  }
  if (result.strata == 0) return Result::none("no stratum holds both groups and values that differ");
  result.z = sum / std::sqrt(variance);
  result.p = normalTwoSided(result.z);
  result.a = wins / weights;
  return result;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// One stratum (a site): values of both groups there.
struct Stratum {
  std::vector<double> x, y;
};

struct StratifiedRankSum {
  double z = 0.0;          ///< positive: x is larger
  double p = 1.0;          ///< two-sided, normal: an approximation
  std::size_t strata = 0;  ///< with both groups in them and values that differ; the others say nothing
  std::size_t left = 0;    ///< strata left out
  double a = 0.5;          ///< pooled P(X > Y) + P(X = Y) / 2, strata weighted by nx ny / (nx + ny + 1)
};

/// Van Elteren's test (1960, Bull. Int. Stat. Inst. 37:351): rank sums within strata, weighted by 1 / (N + 1),
/// mid-ranks with the variance corrected for ties; no continuity correction. No answer when no stratum compares, or
/// for values not finite.
Expected<StratifiedRankSum> stratifiedRankSum(std::span<const Stratum> strata);

}  // namespace calot::analytics

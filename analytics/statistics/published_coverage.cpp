// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/published_coverage.h"

#include <algorithm>

namespace calot::analytics {

std::span<const PublishedCoverage> publishedCoverage() {
  using enum CoveredInterval;
  static constexpr std::array<PublishedCoverage, 9> table{{
      {areaScore, "A, score", "normal, A = 0.50", {93.9, 94.7, 94.8, 95.1}},
      {areaScore, "A, score", "normal, A = 0.75", {96.4, 95.5, 95.6, 95.0}},
      {areaScore, "A, score", "normal, A = 0.95", {96.8, 96.7, 96.8, 97.4}},
      {shift, "shift, Hodges-Lehmann", "normal, shift 1", {96.3, 95.6, 94.8, 95.1}},
      {shift, "shift, Hodges-Lehmann", "normal in halves (ties), shift 1", {98.4, 98.8, 99.3, 99.8}},
      {hedges, "g, non-central t", "normal, 0", {95.0, 94.9, 94.5, 95.1}},
      {hedges, "g, non-central t", "normal, 0.8", {94.4, 95.0, 94.8, 94.7}},
      {hedges, "g, non-central t", "normal, 2", {93.0, 94.5, 94.8, 94.8}},
      {hedges, "g, non-central t", "exponential, 0.8", {93.8, 93.2, 93.2, 92.4}},
  }};
  return table;
}

bool doubtful(CoveredInterval interval, std::size_t nx, std::size_t ny, CoverageDoubt& doubt) {
  const std::size_t n = std::min(nx, ny);
  if (n < coverageSizes.front()) {
    doubt = {.known = false, .percent = 0.0, .size = coverageSizes.front(), .population = ""};
    return true;
  }
  // The first simulated size that is at least n, and the one before it where n lies between the two.
  const auto above =
      static_cast<std::size_t>(std::lower_bound(coverageSizes.begin(), coverageSizes.end(), n) - coverageSizes.begin());
  const std::size_t last = std::min(above, coverageSizes.size() - 1);
  const std::size_t first = above < coverageSizes.size() && coverageSizes[above] == n ? above : above - 1;
  double worst = coverageWanted;
  for (const PublishedCoverage& row : publishedCoverage()) {
    if (row.interval != interval) continue;
    for (std::size_t i = first; i <= last; ++i) {
      if (row.percent[i] >= worst) continue;
      worst = row.percent[i];
      doubt = {.known = true, .percent = worst, .size = coverageSizes[i], .population = row.population};
    }
  }
  return worst < coverageWanted;
}

}  // namespace calot::analytics

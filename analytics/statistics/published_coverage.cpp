// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/published_coverage.h"

#include <algorithm>

namespace calot::analytics {

std::span<const PublishedCoverage> publishedCoverage() {
  using enum CoveredInterval;
  static constexpr std::array<PublishedCoverage, 24> table{{
      {areaScore, "A, score", "normal, A = 0.50", {93.9, 94.7, 94.8, 95.1}},
      {areaScore, "A, score", "normal, A = 0.75", {96.4, 95.5, 95.6, 95.0}},
      {areaScore, "A, score", "normal, A = 0.95", {96.8, 96.7, 96.8, 97.4}},
      {shift, "shift, Hodges-Lehmann", "normal, shift 1", {96.3, 95.6, 94.8, 95.1}},
      {shift, "shift, Hodges-Lehmann", "normal in halves (ties), shift 1", {98.4, 98.8, 99.3, 99.8}},
      {hedges, "g, non-central t", "normal, 0", {95.0, 94.9, 94.5, 95.1}},
      {hedges, "g, non-central t", "normal, 0.8", {94.4, 95.0, 94.8, 94.7}},
      {hedges, "g, non-central t", "normal, 2", {93.0, 94.5, 94.8, 94.8}},
      {hedges, "g, non-central t", "exponential, 0.8", {93.8, 93.2, 93.2, 92.4}},
      {baseline, "difference at one baseline, HC3", "normal, 1", {96.9, 96.0, 95.5, 95.7}},
      {baseline, "difference at one baseline, HC3", "exponential, 1", {97.5, 97.3, 96.0, 95.5}},
      {cut, "cut of contrasting groups", "normal, 70 (5) and 50 (10)", {92.3, 90.7, 93.0, 94.0}},
      {iccSingle, "ICC(2,1)", "normal, 3 raters", {96.4, 95.7, 94.6, 95.2}},
      {iccAverage, "ICC(2,k)", "normal, 3 raters", {97.0, 95.7, 94.6, 95.2}},
      {alpha, "Cronbach's alpha", "normal, 5 items", {94.4, 95.3, 95.7, 95.3}},
      {alpha, "Cronbach's alpha", "exponential, 5 items", {89.2, 85.5, 82.6, 81.5}},
      {limits, "limits of agreement", "normal", {92.2, 93.3, 94.1, 95.0}},
      {limits, "limits of agreement", "exponential", {85.2, 84.8, 84.2, 85.4}},
      {deming, "slope, Deming", "normal, errors 1/2", {95.6, 94.6, 93.8, 94.2}},
      {sdc, "SEM, SDC", "normal, 3 attempts", {94.8, 95.2, 95.3, 95.1}},
      {sdc, "SEM, SDC", "exponential, 3 attempts", {80.2, 78.4, 76.2, 76.7}},
      {borderline, "borderline cut", "normal", {94.7, 95.3, 95.5, 94.6}},
      {spearman, "rho, Spearman", "normal, r = 0.3", {98.7, 96.5, 95.7, 95.6}},
      {spearman, "rho, Spearman", "normal, r = 0.8", {98.7, 95.4, 95.8, 96.2}},
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

// SPDX-License-Identifier: GPL-3.0-or-later
// Percentile bootstrap intervals of any statistic of one or two groups (Efron and Tibshirani 1993). Groups are
// resampled separately; the same seed gives the same interval everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

using Statistic = std::function<Expected<double>(std::span<const double>)>;
using TwoGroupStatistic = std::function<Expected<double>(std::span<const double> x, std::span<const double> y)>;

struct BootstrapOptions {
  std::size_t resamples = 9999;  ///< so that (resamples + 1) times the usual tails is whole
  std::uint64_t seed = 1;
  double level = 0.95;
};

struct Bootstrap {
  double estimate = 0.0;  ///< of the values themselves
  Interval interval;
  std::uint64_t seed = 0;
  std::size_t resamples = 0;
  std::size_t without = 0;  ///< resamples in which the statistic has no answer; left out of the quantiles
  bool extreme = false;     ///< an end is the outermost resample: more resamples, or more people, would move it
};

/// Share of resamples without an answer beyond which there is no interval.
inline constexpr double mostResamplesWithout = 0.05;

/// Quantile p of B sorted resamples: order statistic (B + 1) p, linear in between. No answer when the statistic has
/// none (its reason), for more than mostResamplesWithout, and when all resamples agree. @pre resamples >= 99, 0 < level
/// < 1.
Expected<Bootstrap> bootstrap(std::span<const double> x, const Statistic& statistic,
                              const BootstrapOptions& options = {});
Expected<Bootstrap> bootstrap(std::span<const double> x, std::span<const double> y, const TwoGroupStatistic& statistic,
                              const BootstrapOptions& options = {});

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers, and percentile bootstrap intervals (Efron and Tibshirani 1993): groups are resampled separately; the
// same seed gives the same interval everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "analytics/statistics/expected.h"

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

using ValueGroups = std::vector<std::vector<double>>;
using SeveralOfGroups = std::function<Expected<std::vector<double>>(const ValueGroups&)>;

/// Several statistics of any number of groups, of the same resamples; one answer each. `groups` may hold places of
/// people in a table. Refuses where the statistic refuses the groups themselves. @pre as bootstrap(); no group is
/// empty; the statistic has always as many values.
Expected<std::vector<Expected<Bootstrap>>> bootstrapSeveral(const ValueGroups& groups, const SeveralOfGroups& statistic,
                                                            const BootstrapOptions& options = {});

/// Random numbers for resampling and simulation: 64-bit Mersenne Twister, whose bits the C++ standard fixes, with
/// mappings of our own, since the standard library's own differ between libraries. Whoever uses one reports its seed.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in 0 .. n - 1, without the bias of a plain remainder (values below 2^64 mod n are drawn again).
  /// @pre n > 0.
  std::uint64_t below(std::uint64_t n);
  /// Uniform in (0, 1): the middles of 2^52 cells, so that neither end occurs.
  double uniform();
  /// Standard normal, by the quantile of one uniform().
  double normal();

 private:
  std::mt19937_64 engine_;
};

}  // namespace calot::analytics

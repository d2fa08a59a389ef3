// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/resampling.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {
namespace {

/// Order statistic (B + 1) p, linear in between; `extreme` is set where that is outside of them.
double tail(const std::vector<double>& sorted, double p, bool& extreme) {
  const double count = static_cast<double>(sorted.size()), place = (count + 1.0) * p;
  if (place <= 1.0 || place >= count) extreme = true;
  const double inside = std::clamp(place, 1.0, count);
  const double below = std::min(std::floor(inside), count - 1.0);
  const auto i = static_cast<std::size_t>(below) - 1;
  return sorted[i] + (inside - below) * (sorted[i + 1] - sorted[i]);
}

/// Interval of one statistic. @param bootstrap its estimate, seed, resamples, and how many of these are without an
/// answer
Expected<Bootstrap> intervalOf(std::vector<double> values, Bootstrap bootstrap, double level) {
  std::sort(values.begin(), values.end());
  if (values.front() == values.back()) return NoResult{"all resamples agree"};
  const double half = (1.0 - level) / 2.0;
  bootstrap.interval.lower = tail(values, half, bootstrap.extreme);
  bootstrap.interval.upper = tail(values, 1.0 - half, bootstrap.extreme);
  bootstrap.interval.level = level;
  bootstrap.interval.method = "percentile bootstrap";
  return bootstrap;
}

/// The one of bootstrapSeveral().
Expected<Bootstrap> bootstrapOne(const ValueGroups& groups,
                                 const std::function<Expected<double>(const ValueGroups&)>& statistic,
                                 const BootstrapOptions& options) {
  const auto several = bootstrapSeveral(
      groups,
      [&](const ValueGroups& g) -> Expected<std::vector<double>> {
        const Expected<double> value = statistic(g);
        if (!value) return NoResult{value.reason()};
        return std::vector<double>{*value};
      },
      options);
  if (!several) return NoResult{several.reason()};
  return several->front();
}

}  // namespace

Expected<Bootstrap> bootstrap(std::span<const double> x, const Statistic& statistic, const BootstrapOptions& options) {
  if (x.empty()) return NoResult{"no values"};
  if (!allFinite(x)) return NoResult{"a value is not finite"};
  return bootstrapOne(
      {{x.begin(), x.end()}}, [&](const ValueGroups& g) { return statistic(g[0]); }, options);
}

Expected<Bootstrap> bootstrap(std::span<const double> x, std::span<const double> y, const TwoGroupStatistic& statistic,
                              const BootstrapOptions& options) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  return bootstrapOne(
      {{x.begin(), x.end()}, {y.begin(), y.end()}}, [&](const ValueGroups& g) { return statistic(g[0], g[1]); },
      options);
}

Expected<std::vector<Expected<Bootstrap>>> bootstrapSeveral(const ValueGroups& groups, const SeveralOfGroups& statistic,
                                                            const BootstrapOptions& options) {
  assert(options.resamples >= 99 && options.level > 0.0 && options.level < 1.0);
  const Expected<std::vector<double>> estimate = statistic(groups);
  if (!estimate) return NoResult{estimate.reason()};
  Bootstrap common;
  common.seed = options.seed;
  common.resamples = options.resamples;
  RandomStream random(options.seed);
  std::vector<std::vector<double>> values(estimate->size());
  for (std::vector<double>& of : values) of.reserve(options.resamples);
  ValueGroups drawn = groups;
  std::string lastReason;
  for (std::size_t resample = 0; resample < options.resamples; ++resample) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (double& v : drawn[g]) v = groups[g][static_cast<std::size_t>(random.below(groups[g].size()))];
    }
    if (const Expected<std::vector<double>> value = statistic(drawn)) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i].push_back((*value)[i]);
    } else {
      ++common.without;
      lastReason = value.reason();
    }
  }
  if (static_cast<double>(common.without) > mostResamplesWithout * static_cast<double>(options.resamples)) {
    return NoResult{std::to_string(common.without) + " of " + std::to_string(options.resamples) +
                    " resamples have no answer (" + lastReason + ")"};
  }
  std::vector<Expected<Bootstrap>> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Bootstrap one = common;
    one.estimate = (*estimate)[i];
    result.push_back(intervalOf(std::move(values[i]), one, options.level));
  }
  return result;
}

std::uint64_t RandomStream::below(std::uint64_t n) {
  assert(n > 0);
  const std::uint64_t excess = (std::uint64_t{0} - n) % n;
  std::uint64_t bits = engine_();
  while (bits < excess) bits = engine_();
  return bits % n;
}

double RandomStream::uniform() { return (static_cast<double>(engine_() >> 12U) + 0.5) * 0x1p-52; }

double RandomStream::normal() { return normalQuantile(uniform()); }

}  // namespace calot::analytics

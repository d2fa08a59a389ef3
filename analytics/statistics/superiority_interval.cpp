// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/superiority_interval.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/roots.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

/// [lower, upper] of Newcombe's method 5.
Interval scoreInterval(double a, double nx, double ny, double z, double level) {
  const double extra = (nx + ny) / 2.0 - 1.0;
  const auto excess = [&](double t) {
    const double spread = t * (1.0 - t) * (1.0 + extra * ((1.0 - t) / (2.0 - t) + t / (1.0 + t))) / (nx * ny);
    return (a - t) * (a - t) - z * z * spread;
  };
  // Positive outside of the interval, negative inside; zero at A itself where A is 0 or 1, hence the step inwards.
  constexpr double step = 1e-9;
  Interval result{0.0, 1.0, level, "score"};
  if (a > 0.0) result.lower = rootBetween(excess, 0.0, std::min(a, 1.0 - step));
  if (a < 1.0) result.upper = rootBetween(excess, std::max(a, step), 1.0);
  return result;
}

}  // namespace

Expected<SuperiorityEstimate> estimateSuperiority(std::span<const double> x, std::span<const double> y,
                                                  Hypothesis hypothesis, double level) {
  using Result = Expected<SuperiorityEstimate>;
  assert(level > 0.0 && level < 1.0);
  if (hypothesis == Hypothesis::firstSmaller) std::swap(x, y);
  const Expected<Superiority> value = superiority(x, y);
  if (!value) return Result::none(hypothesis == Hypothesis::firstSmaller ? twoGroupObjection(y, x) : value.reason());
  const double n = static_cast<double>(x.size() + y.size());
  if (tieTerm(pooled(x, y)) == n * n * n - n) return Result::none("all values are equal");
  SuperiorityEstimate result;
  result.value = *value;
  const double a = value->a, z = normalQuantile(0.5 + level / 2.0);
  result.a = scoreInterval(a, static_cast<double>(x.size()), static_cast<double>(y.size()), z, level);
  result.delta = {2.0 * result.a.lower - 1.0, 2.0 * result.a.upper - 1.0, level, result.a.method};
  return result;
}

}  // namespace calot::analytics

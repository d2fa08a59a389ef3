// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/effect_sizes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

Expected<HedgesG> hedgesG(std::span<const double> x, std::span<const double> y, double level) {
  using Result = Expected<HedgesG>;
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Result::none(reason);
  if (x.size() < 2 || y.size() < 2) return Result::none("a group of one value has no spread");
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size()), m = nx + ny - 2.0;
  const double sx = *standardDeviation(x), sy = *standardDeviation(y);
  const double spread = std::sqrt(((nx - 1.0) * sx * sx + (ny - 1.0) * sy * sy) / m);
  if (!(spread > 0.0)) return Result::none("no spread within the groups");
  HedgesG result;
  result.d = (*mean(x) - *mean(y)) / spread;
  // Logarithms: Gamma itself overflows beyond 340 values.
  result.j = std::exp(std::lgamma(m / 2.0) - std::lgamma((m - 1.0) / 2.0)) / std::sqrt(m / 2.0);
  result.g = result.j * result.d;
  const double scale = std::sqrt(nx * ny / (nx + ny)), t = result.d * scale, tail = (1.0 - level) / 2.0;
  const double lower = noncentralStudentParameter(t, m, 1.0 - tail), upper = noncentralStudentParameter(t, m, tail);
  if (std::isfinite(lower) && std::isfinite(upper)) {
    result.interval = Interval{result.j * lower / scale, result.j * upper / scale, level, "J times non-central t"};
  } else {
    result.interval = Expected<Interval>::none("the effect is too large for the non-central t distribution");
  }
  return result;
}

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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/hedges.h"

#include <cmath>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/samples.h"

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

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/welch.h"

#include <cmath>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {

Expected<Welch> welch(std::span<const double> x, std::span<const double> y, double level) {
  using Result = Expected<Welch>;
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Result::none(reason);
  if (x.size() < 2 || y.size() < 2) return Result::none("a group of one value has no spread");
  const double sx = *standardDeviation(x), sy = *standardDeviation(y);
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size());
  const double a = sx * sx / nx, b = sy * sy / ny;
  if (!(a + b > 0.0)) return Result::none("no spread within the groups");
  Welch w;
  w.difference = *mean(x) - *mean(y);
  w.t = w.difference / std::sqrt(a + b);
  // Uses shares of the variance instead of a and b themselves, whose squares could underflow.
  const double ra = a / (a + b), rb = b / (a + b);
  w.df = 1.0 / (ra * ra / (nx - 1.0) + rb * rb / (ny - 1.0));
  w.p = studentTwoSided(w.t, w.df);
  const double half = studentQuantile(0.5 + level / 2.0, w.df) * std::sqrt(a + b);
  w.interval = {w.difference - half, w.difference + half, level, "Welch's t"};
  return w;
}

}  // namespace calot::analytics

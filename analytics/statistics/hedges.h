// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

struct HedgesG {
  double g = 0.0;  ///< J d
  double d = 0.0;  ///< Cohen's: (mx - my) / s, s^2 the pooled variance with nx + ny - 2
  double j = 1.0;  ///< small-sample correction
  /// "J times non-central t": the non-centralities at which t = d sqrt(nx ny / (nx + ny)) is the upper and the lower
  /// quantile, converted back to d, times J. Assumes normal groups of one variance.
  Expected<Interval> interval = Expected<Interval>::none("not computed");
};

/// Hedges' g (Hedges 1981, J. Educ. Stat. 6:107): J = Gamma(m / 2) / (sqrt(m / 2) Gamma((m - 1) / 2)), m = nx + ny - 2.
/// No answer for fewer than two values in a group or when there is no spread within both. @pre 0 < level < 1.
Expected<HedgesG> hedgesG(std::span<const double> x, std::span<const double> y, double level = 0.95);

}  // namespace calot::analytics

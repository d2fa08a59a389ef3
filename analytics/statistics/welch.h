// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

struct Welch {
  double difference = 0.0;  ///< mean of x less mean of y
  double t = 0.0;
  double df = 0.0;
  double p = 1.0;  ///< two-sided
  Interval interval;
};

/// Welch's t test of two means with unequal variances (Welch 1947, Biometrika 34:28), where a = sx^2 / nx and b
/// = sy^2 / ny:
///   t = (mx - my) / sqrt(a + b),   df = (a + b)^2 / (a^2 / (nx - 1) + b^2 / (ny - 1)).
/// No answer for fewer than two values in a group, or when neither group has any spread. @pre 0 < level < 1.
Expected<Welch> welch(std::span<const double> x, std::span<const double> y, double level = 0.95);

}  // namespace calot::analytics

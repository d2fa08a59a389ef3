// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// Arithmetic mean. No answer for no values or for values that are not finite.
Expected<double> mean(std::span<const double> values);

/// Sample standard deviation (divisor n - 1, two passes). No answer for fewer than two values.
Expected<double> standardDeviation(std::span<const double> values);

/// Sample quantile of type 7 (Hyndman and Fan 1996; the default of R and NumPy): with h = (n - 1) p, linear between the
/// order statistics around h. @pre 0 <= p <= 1.
Expected<double> quantile(std::span<const double> values, double p);

/// The same of values that are sorted ascending and finite. @pre not empty.
double quantileOfSorted(std::span<const double> sorted, double p);

/// Quantile of type 7 at 1/2.
Expected<double> median(std::span<const double> values);

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

namespace calot::bench {

/// The value below which a share `q` of the values lies (nearest rank). @pre values is not empty
double quantile(std::vector<double> values, double q);

/// Slope of log y over log x by least squares: y grows as x to this power. @pre at least two different x, all positive
double growthExponent(std::span<const double> x, std::span<const double> y);

}  // namespace calot::bench

// SPDX-License-Identifier: GPL-3.0-or-later
// Input checks common to all statistics.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace calot::analytics {

/// Neither NaN nor infinite.
bool allFinite(std::span<const double> values);

/// Why two groups can't be compared at all, or empty: a group is empty, a value is not finite.
std::string twoGroupObjection(std::span<const double> x, std::span<const double> y);

/// The values of x, then those of y.
std::vector<double> pooled(std::span<const double> x, std::span<const double> y);

/// Sum of t^3 - t over the sets of t equal values: the correction for ties of every rank test; 0 without ties, and n^3
/// - n where all n values are equal.
double tieTerm(std::span<const double> values);

}  // namespace calot::analytics

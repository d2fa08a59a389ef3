// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

struct Spearman {
  double rho = 0.0;
  double p = 1.0;      ///< two-sided
  bool exact = false;  ///< over all orders; else by Student's t
  bool ties = false;
};

/// Pairs up to which all n! orders are gone through.
inline constexpr std::size_t exactSpearmanLimit = 9;

/// Spearman's rank correlation (1904): Pearson's of the mid-ranks. Exact: the share of all orders of one variable in
/// which |rho| is at least as large, ties included. Beyond exactSpearmanLimit pairs t = rho sqrt((n - 2) / (1 - rho^2))
/// with n - 2 degrees of freedom (Kendall and Stuart), and for |rho| = 1, where t is infinite, the bound 2 prod(t!) /
/// n! over the ties. No answer for lengths that differ, fewer than three pairs, or a variable with all values equal.
Expected<Spearman> spearman(std::span<const double> x, std::span<const double> y);

/// tanh(atanh rho -+ z sqrt((1 + rho^2 / 2) / (n - 3))) (Bonett and Wright 2000, Psychometrika 65:23). No answer for
/// fewer than four pairs or |rho| = 1, where it would be a point. @pre 0 < level < 1.
Expected<Interval> spearmanInterval(double rho, std::size_t n, double level = 0.95);

}  // namespace calot::analytics

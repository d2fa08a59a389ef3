// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

/// One group before and after: value i of both is the same person's.
struct BaselineGroup {
  std::span<const double> baseline, outcome;
};

struct CovarianceAnalysis {
  double difference = 0.0;            ///< of x to y at one baseline: coefficient b of outcome = a + b [x] + c baseline
  double error = 0.0;                 ///< HC3
  double t = 0.0, df = 0.0, p = 1.0;  ///< Student, df = people - 3; two-sided
  Interval interval;
  double slope = 0.0;  ///< c
  /// p of one slope for both groups (coefficient of [x] baseline, HC3). Small: the difference depends on the baseline,
  /// and one number does not describe it.
  Expected<double> sameSlope = Expected<double>::none("not computed");
};

/// Analysis of covariance of an outcome on its baseline (Vickers and Altman 2001, BMJ 323:1123) by least squares
/// with HC3 errors. No answer for an empty group, lengths that differ, fewer than four people, a baseline that is
/// constant or that the group determines, one person who alone determines a coefficient (a group of one), or
/// outcomes without any scatter.
Expected<CovarianceAnalysis> covarianceAnalysis(const BaselineGroup& x, const BaselineGroup& y, double level = 0.95);

}  // namespace calot::analytics

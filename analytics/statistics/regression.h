// SPDX-License-Identifier: GPL-3.0-or-later
// Least squares, the analysis of covariance of two groups, and the learning curve.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// y = X b + e, by a pivoted QR factorisation of X with its columns scaled to one length. Small problems: dense.
struct LeastSquares {
  std::vector<double> coefficients;  ///< b, a column each
  std::vector<double> residuals;
  std::vector<double> leverages;  ///< diagonal h of X (X'X)^-1 X'
  std::vector<double> unscaled;   ///< (X'X)^-1, row after row; times sigma^2 the usual covariance of b
  double residualSumOfSquares = 0.0;
  double df = 0.0;              ///< values less columns
  double sigma = 0.0;           ///< sqrt(residualSumOfSquares / df)
  double logDeterminant = 0.0;  ///< ln |X'X|

  /// sigma times the root of the diagonal: errors where all residuals have one variance.
  [[nodiscard]] std::vector<double> standardErrors() const;
};

/// @param columns of X, each as long as y. No answer for lengths that differ, values not finite, no more values than
/// columns, or columns that depend on each other linearly.
Expected<LeastSquares> leastSquares(const std::vector<std::vector<double>>& columns, std::span<const double> y);

/// Errors that hold where the residuals' variances differ: roots of the diagonal of (X'X)^-1 X' diag(e^2 / (1 - h)^2) X
/// (X'X)^-1, HC3 (MacKinnon and White 1985, J. Econometrics 29:305). No answer where a value has leverage 1: it alone
/// determines a coefficient.
Expected<std::vector<double>> hc3Errors(const LeastSquares& fit, const std::vector<std::vector<double>>& columns);

/// One coefficient with its test by Student's t, two-sided.
struct ModelTerm {
  double estimate = 0.0, error = 0.0, t = 0.0, df = 0.0, p = 1.0;
  Interval interval;
};
ModelTerm modelTerm(double estimate, double error, double df, double level, const char* method);

/// One group before and after: value i of both is the same person's.
struct BaselineGroup {
  std::span<const double> baseline, outcome;
};

/// Difference of x to y at one baseline: coefficient b of outcome = a + b [x] + c baseline, with its HC3 error and
/// people - 3 degrees of freedom.
struct CovarianceAnalysis : ModelTerm {
  double slope = 0.0;  ///< c
  /// p of one slope for both groups (coefficient of [x] baseline, HC3). Small: the difference depends on the baseline,
  /// and one number does not describe it.
  Expected<double> sameSlope = NoResult{"not computed"};
};

/// Analysis of covariance of an outcome on its baseline (Vickers and Altman 2001, BMJ 323:1123) by least squares
/// with HC3 errors. No answer for an empty group, lengths that differ, fewer than four people, a baseline that is
/// constant or that the group determines, one person who alone determines a coefficient (a group of one), or
/// outcomes without any scatter.
Expected<CovarianceAnalysis> covarianceAnalysis(const BaselineGroup& x, const BaselineGroup& y, double level = 0.95);

/// A figure over the number x >= 1 of the attempt, a - b / x: towards the plateau a, from below (b > 0) or from above
/// (b < 0). It is the power law of practice a - b x^-c with c = 1.
struct LearningCurve {
  double plateau = 0.0;                       ///< a, the figure's unit
  double gap = 0.0;                           ///< b: what is missing at x = 1
  double plateauError = 0.0, gapError = 0.0;  ///< standard errors, from s^2 (X'X)^-1
  double residualSumOfSquares = 0.0;
  double sigma = 0.0;       ///< sqrt(residualSumOfSquares / freedom)
  double covariance = 0.0;  ///< of plateau and gap
  std::size_t freedom = 0;  ///< values - 2

  [[nodiscard]] double at(double x) const { return plateau - gap / x; }
};

/// Least squares; the curve is linear in a and b. No answer for x that is not positive or not finite, fewer than two
/// distinct x or than three values, and values all equal.
Expected<LearningCurve> fitLearningCurve(std::span<const double> x, std::span<const double> y);

/// Interval of the curve itself at x, by Student's t: a - b / x is linear in a and b, so its variance is
/// Var a - 2 Cov(a, b) / x + Var b / x^2 (Draper and Smith 1998, 1.4).
/// @pre x > 0, 0 < level < 1, curve.freedom > 0
Interval bandOf(const LearningCurve& curve, double x, double level = 0.95);

}  // namespace calot::analytics

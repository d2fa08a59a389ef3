// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions and roots from Boost.Math used by the statistics.
#pragma once

#include <functional>

namespace calot::analytics {

/// @pre 0 < p < 1, here and below.
double normalQuantile(double p);
/// P(|Z| >= |z|).
double normalTwoSided(double z);

/// Student's t. @pre df > 0, not necessarily whole.
double studentQuantile(double p, double df);
/// P(|T| >= |t|).
double studentTwoSided(double t, double df);

/// Upper tail of chi-squared. @pre x >= 0.
double chiSquaredUpper(double x, double df);
double chiSquaredQuantile(double p, double df);

/// Fisher's F. @pre df1 > 0, df2 > 0.
double fisherQuantile(double p, double df1, double df2);

/// Non-centrality for which P(T <= t) = p, T non-central t with df degrees of freedom. NaN where the series of Boost
/// does not converge (|t| beyond some hundreds).
double noncentralStudentParameter(double t, double df, double p);

/// Root of a continuous function between two points of opposite sign, to machine precision (Alefeld, Potra and Shi's
/// algorithm 748 of Boost.Math). @pre lower < upper; f(lower) f(upper) <= 0.
double rootBetween(const std::function<double(double)>& f, double lower, double upper);

}  // namespace calot::analytics

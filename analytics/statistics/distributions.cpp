// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/distributions.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>

namespace calot::analytics {

namespace bm = boost::math;

double normalQuantile(double p) { return bm::quantile(bm::normal(), p); }
double normalTwoSided(double z) { return std::min(1.0, 2.0 * bm::cdf(bm::complement(bm::normal(), std::abs(z)))); }

double studentQuantile(double p, double df) { return bm::quantile(bm::students_t(df), p); }
double studentTwoSided(double t, double df) {
  return std::min(1.0, 2.0 * bm::cdf(bm::complement(bm::students_t(df), std::abs(t))));
}

double chiSquaredUpper(double x, double df) { return bm::cdf(bm::complement(bm::chi_squared(df), x)); }

double chiSquaredQuantile(double p, double df) { return bm::quantile(bm::chi_squared(df), p); }

double fisherQuantile(double p, double df1, double df2) { return bm::quantile(bm::fisher_f(df1, df2), p); }

double noncentralStudentParameter(double t, double df, double p) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  try {
    // Falls with the non-centrality. The spread of T grows with it as |delta| / sqrt(2 df).
    const auto excess = [&](double delta) { return bm::cdf(bm::non_central_t(df, delta), t) - p; };
    double width = 4.0 + std::abs(t) / std::sqrt(df);
    double lower = t - width, upper = t + width;
    for (int i = 0; i < 20 && !(excess(lower) > 0.0); ++i) lower -= (width *= 1.5);
    width = 4.0;
    for (int i = 0; i < 20 && !(excess(upper) < 0.0); ++i) upper += (width *= 1.5);
    if (!(excess(lower) > 0.0) || !(excess(upper) < 0.0)) return none;
    return rootBetween(excess, lower, upper);
  } catch (const std::exception&) {
    return none;
  }
}

double rootBetween(const std::function<double(double)>& f, double lower, double upper) {
  const double atLower = f(lower), atUpper = f(upper);
  if (atLower == 0.0) return lower;
  if (atUpper == 0.0) return upper;
  assert(atLower * atUpper < 0.0);
  std::uintmax_t iterations = 200;
  const auto bracket =
      bm::tools::toms748_solve(f, lower, upper, atLower, atUpper, bm::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

}  // namespace calot::analytics

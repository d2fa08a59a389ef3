// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/intraclass_correlation.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "analytics/statistics/distributions.h"

namespace calot::analytics {
namespace {

struct Design {
  MeanSquares s;
  double n = 0.0, k = 0.0;
};

/// Of ICC(3,k); lower and upper alone. That of the single form, (F - 1) / (F + k - 1), by Spearman and Brown.
Interval ofThreeAverage(const Design& d, double p) {
  const double f = d.s.subjects / d.s.residual, df1 = d.n - 1.0, df2 = df1 * (d.k - 1.0);
  return {1.0 - fisherQuantile(p, df1, df2) / f, 1.0 - 1.0 / (f * fisherQuantile(p, df2, df1)), 0.0, "F"};
}

/// Not finite where the approximation breaks down (negative correlations).
Interval ofTwoSingle(double icc, const Design& d, double p) {
  const double n = d.n, k = d.k, s = d.s.subjects, r = d.s.raters, e = d.s.residual;
  const double f = r / e, rest = n * (1.0 + (k - 1.0) * icc) - k * icc;
  const double numerator = k * icc * f + rest;
  const double df =
      (k - 1.0) * (n - 1.0) * numerator * numerator / ((n - 1.0) * k * k * icc * icc * f * f + rest * rest);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!(df > 0.0) || !std::isfinite(df)) return {none, none, 0.0, {}};
  const double above = fisherQuantile(p, n - 1.0, df), below = fisherQuantile(p, df, n - 1.0);
  const double noise = k * r + (k * n - k - n) * e;
  return {n * (s - above * e) / (above * noise + n * s), n * (below * s - e) / (noise + n * below * s), 0.0,
          "F, Satterthwaite"};
}

}  // namespace

const char* nameOf(IccForm form) {
  switch (form) {
    case IccForm::twoSingle:
      return "ICC(2,1)";
    case IccForm::twoAverage:
      return "ICC(2,k)";
    case IccForm::threeAverage:
      return "ICC(3,k)";
  }
  return "";
}

Expected<IntraclassCorrelation> intraclassCorrelation(const RatingTable& table, IccForm form, double level) {
  using Result = Expected<IntraclassCorrelation>;
  assert(level > 0.0 && level < 1.0);
  if (const std::string reason = objection(table); !reason.empty()) return Result::none(reason);
  const Design d{meanSquares(table), static_cast<double>(table.subjects), static_cast<double>(table.raters)};
  const double n = d.n, k = d.k, s = d.s.subjects, r = d.s.raters, e = d.s.residual;
  const double leniency = form == IccForm::threeAverage ? 0.0 : (r - e) / n;
  const double ofOne = s + (k - 1.0) * e + k * leniency, ofAll = s + leniency;
  const double denominator = form == IccForm::twoSingle ? ofOne : ofAll;
  if (!(denominator > 0.0)) return Result::none("no differences between subjects");
  IntraclassCorrelation result;
  result.value = (s - e) / denominator;
  if (!(e > 0.0)) {
    result.interval = Expected<Interval>::none("the raters agree perfectly but for leniency");
    return result;
  }
  const double p = 0.5 + level / 2.0;
  Interval interval = form == IccForm::threeAverage ? ofThreeAverage(d, p) : ofTwoSingle((s - e) / ofOne, d, p);
  interval.level = level;
  if (form == IccForm::twoAverage) {
    for (double* end : {&interval.lower, &interval.upper}) *end = k * *end / (1.0 + (k - 1.0) * *end);
  }
  const bool sound = std::isfinite(interval.lower) && std::isfinite(interval.upper) && interval.lower <= interval.upper;
  result.interval =
      sound ? Expected<Interval>(interval) : Expected<Interval>::none("the approximate interval breaks down");
  return result;
}

}  // namespace calot::analytics

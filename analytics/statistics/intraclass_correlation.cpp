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

/// Of the single form; lower and upper alone.
Interval ofRatio(double error, double df2, const Design& d, double p) {
  const double f = d.s.subjects / error, df1 = d.n - 1.0;
  const double lower = f / fisherQuantile(p, df1, df2), upper = f * fisherQuantile(p, df2, df1);
  return {(lower - 1.0) / (lower + d.k - 1.0), (upper - 1.0) / (upper + d.k - 1.0), 0.0, "F"};
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
    case IccForm::oneSingle:
      return "ICC(1,1)";
    case IccForm::twoSingle:
      return "ICC(2,1)";
    case IccForm::threeSingle:
      return "ICC(3,1)";
    case IccForm::oneAverage:
      return "ICC(1,k)";
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
  const double n = d.n, k = d.k, s = d.s.subjects, r = d.s.raters, e = d.s.residual, w = d.s.within;
  const bool one = form == IccForm::oneSingle || form == IccForm::oneAverage;
  const bool two = form == IccForm::twoSingle || form == IccForm::twoAverage;
  const bool average = form == IccForm::oneAverage || form == IccForm::twoAverage || form == IccForm::threeAverage;
  const double error = one ? w : e;
  const double leniency = two ? (r - e) / n : 0.0;
  const double denominator = average ? s + leniency : s + (k - 1.0) * error + k * leniency;
  if (!(denominator > 0.0)) return Result::none("no differences between subjects");
  IntraclassCorrelation result;
  result.value = (s - error) / denominator;
  if (!(error > 0.0)) {
    result.interval =
        Expected<Interval>::none(one ? "the raters agree perfectly" : "the raters agree perfectly but for leniency");
    return result;
  }
  const double p = 0.5 + level / 2.0;
  Interval interval;
  if (two) {
    const double single = (s - e) / (s + (k - 1.0) * e + k * leniency);
    interval = ofTwoSingle(single, d, p);
  } else {
    interval = ofRatio(error, one ? n * (k - 1.0) : (n - 1.0) * (k - 1.0), d, p);
  }
  interval.level = level;
  if (average) {
    for (double* end : {&interval.lower, &interval.upper}) *end = k * *end / (1.0 + (k - 1.0) * *end);
  }
  const bool sound = std::isfinite(interval.lower) && std::isfinite(interval.upper) && interval.lower <= interval.upper;
  result.interval =
      sound ? Expected<Interval>(interval) : Expected<Interval>::none("the approximate interval breaks down");
  return result;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/reliability.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

std::string objection(const RatingTable& table) {
  if (table.values.size() != table.subjects * table.raters) return "the table is not complete";
  if (table.subjects < 2) return "fewer than two subjects";
  if (table.raters < 2) return "fewer than two columns";
  if (!allFinite(table.values)) return "a value is not finite";
  if (std::all_of(table.values.begin(), table.values.end(), [&](double v) { return v == table.values.front(); }))
    return "all values are equal";
  return {};
}

MeanSquares meanSquares(const RatingTable& table) {
  const double n = static_cast<double>(table.subjects), k = static_cast<double>(table.raters);
  const double grand = *mean(table.values);
  std::vector<double> row(table.subjects, 0.0), column(table.raters, 0.0);
  for (std::size_t i = 0; i < table.subjects; ++i) {
    for (std::size_t j = 0; j < table.raters; ++j) {
      row[i] += (table.at(i, j) - grand) / k;
      column[j] += (table.at(i, j) - grand) / n;
    }
  }
  double rows = 0.0, columns = 0.0, rest = 0.0, largest = 0.0;
  for (const double r : row) rows += k * r * r;
  for (const double c : column) columns += n * c * c;
  for (std::size_t i = 0; i < table.subjects; ++i) {
    for (std::size_t j = 0; j < table.raters; ++j) {
      const double e = table.at(i, j) - grand - row[i] - column[j];
      rest += e * e;
      largest = std::max(largest, std::abs(table.at(i, j)));
    }
  }
  // Residual of an exact fit by rounding alone: some units in the last place of the values, squared.
  const double last = 8.0 * std::numeric_limits<double>::epsilon() * largest, rounding = n * k * last * last;
  if (rest < rounding) rest = 0.0;
  if (rows < rounding) rows = 0.0;
  if (columns < rounding) columns = 0.0;
  if (columns < rounding) columns = 0.0;
  return {rows / (n - 1.0), columns / (k - 1.0), rest / ((n - 1.0) * (k - 1.0))};
}

Expected<CronbachAlpha> cronbachAlpha(const RatingTable& items, double level) {
  assert(level > 0.0 && level < 1.0);
  if (items.raters < 3) return NoResult{"fewer than three items"};
  if (const std::string reason = objection(items); !reason.empty()) return NoResult{reason};
  const MeanSquares s = meanSquares(items);
  if (!(s.subjects > 0.0)) return NoResult{"the sums of all subjects are equal"};
  CronbachAlpha result;
  const double error = s.residual / s.subjects;  // 1 - alpha
  result.value = 1.0 - error;
  if (!(error > 0.0)) {
    result.interval = NoResult{"the items agree perfectly"};
    return result;
  }
  const double df1 = static_cast<double>(items.subjects) - 1.0, df2 = df1 * (static_cast<double>(items.raters) - 1.0);
  const double tail = (1.0 - level) / 2.0;
  result.interval = Interval{1.0 - error * fisherQuantile(1.0 - tail, df1, df2),
                             1.0 - error * fisherQuantile(tail, df1, df2), level, "Feldt's F"};
  return result;
}

namespace {

struct Design {
  MeanSquares s;
  double n = 0.0, k = 0.0;
};

/// ICC(3,k): lower and upper alone. The interval of the single form, (F - 1) / (F + k - 1), by Spearman and Brown.
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

Expected<IntraclassCorrelation> intraclassCorrelation(const RatingTable& table, IccForm form, double level) {
  assert(level > 0.0 && level < 1.0);
  if (const std::string reason = objection(table); !reason.empty()) return NoResult{reason};
  const Design d{meanSquares(table), static_cast<double>(table.subjects), static_cast<double>(table.raters)};
  const double n = d.n, k = d.k, s = d.s.subjects, r = d.s.raters, e = d.s.residual;
  const double leniency = form == IccForm::threeAverage ? 0.0 : (r - e) / n;
  const double ofOne = s + (k - 1.0) * e + k * leniency, ofAll = s + leniency;
  const double denominator = form == IccForm::twoSingle ? ofOne : ofAll;
  if (!(denominator > 0.0)) return NoResult{"no differences between subjects"};
  IntraclassCorrelation result;
  result.value = (s - e) / denominator;
  if (!(e > 0.0)) {
    result.interval = NoResult{"the raters agree perfectly but for leniency"};
    return result;
  }
  const double p = 0.5 + level / 2.0;
  Interval interval = form == IccForm::threeAverage ? ofThreeAverage(d, p) : ofTwoSingle((s - e) / ofOne, d, p);
  interval.level = level;
  if (form == IccForm::twoAverage) {
    for (double* end : {&interval.lower, &interval.upper}) *end = k * *end / (1.0 + (k - 1.0) * *end);
  }
  const bool sound = std::isfinite(interval.lower) && std::isfinite(interval.upper) && interval.lower <= interval.upper;
  result.interval = sound ? Expected<Interval>(interval) : NoResult{"the approximate interval breaks down"};
  return result;
}

Expected<MeasurementError> measurementError(std::span<const RepeatedValue> values, double level) {
  std::map<std::size_t, std::vector<double>> of;
  for (const RepeatedValue& v : values) {
    if (!std::isfinite(v.value)) return NoResult{"a value is not finite"};
    of[v.participant].push_back(v.value);
  }
  MeasurementError result;
  double squares = 0.0;
  for (const auto& item : of) {
    if (item.second.size() < 2) continue;
    ++result.people;
    result.attempts += item.second.size();
    const double middle = *mean(item.second);
    for (const double v : item.second) squares += (v - middle) * (v - middle);
  }
  if (result.people == 0) return NoResult{"nobody has two attempts"};
  if (!(squares > 0.0)) return NoResult{"attempts of each participant are all equal"};
  result.df = static_cast<double>(result.attempts - result.people);
  result.sem = std::sqrt(squares / result.df);
  const double factor = normalQuantile(0.975) * std::sqrt(2.0);
  result.sdc = factor * result.sem;
  const double lower = std::sqrt(squares / chiSquaredQuantile(0.5 + level / 2.0, result.df));
  const double upper = std::sqrt(squares / chiSquaredQuantile(0.5 - level / 2.0, result.df));
  result.semInterval = {lower, upper, level, "chi-squared"};
  result.sdcInterval = {factor * lower, factor * upper, level, "chi-squared"};
  return result;
}

Expected<BlandAltman> blandAltman(std::span<const double> first, std::span<const double> second, double level) {
  if (first.size() != second.size()) return NoResult{"the two variables have different lengths"};
  if (first.size() < 3) return NoResult{"fewer than three pairs"};
  if (!allFinite(first) || !allFinite(second)) return NoResult{"a value is not finite"};
  std::vector<double> differences;
  for (std::size_t i = 0; i < first.size(); ++i) differences.push_back(first[i] - second[i]);
  BlandAltman result;
  result.pairs = first.size();
  result.bias = *mean(differences);
  result.deviation = *standardDeviation(differences);
  if (!(result.deviation > 0.0)) return NoResult{"all differences are equal"};
  const double n = static_cast<double>(result.pairs), z = normalQuantile(0.975);
  result.lower = result.bias - z * result.deviation;
  result.upper = result.bias + z * result.deviation;
  const double t = studentQuantile(0.5 + level / 2.0, n - 1.0);
  const auto around = [&](double value, double variance) {
    const double half = t * result.deviation * std::sqrt(variance);
    return Interval{value - half, value + half, level, "Student's t"};
  };
  const double ofLimit = 1.0 / n + z * z / (2.0 * (n - 1.0));
  result.biasInterval = around(result.bias, 1.0 / n);
  result.lowerInterval = around(result.lower, ofLimit);
  result.upperInterval = around(result.upper, ofLimit);
  return result;
}

namespace {

struct DemingLine {
  double intercept = 0.0, slope = 1.0;
};

std::optional<DemingLine> demingLine(std::span<const double> x, std::span<const double> y, double errorRatio) {
  const double mx = *mean(x), my = *mean(y);
  double sxx = 0.0, syy = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sxx += (x[i] - mx) * (x[i] - mx);
    syy += (y[i] - my) * (y[i] - my);
    sxy += (x[i] - mx) * (y[i] - my);
  }
  if (sxy == 0.0) return std::nullopt;
  const double apart = syy - errorRatio * sxx, root = std::hypot(apart, 2.0 * std::sqrt(errorRatio) * sxy);
  // The form without cancellation.
  const double slope = apart >= 0.0 ? (apart + root) / (2.0 * sxy) : 2.0 * errorRatio * sxy / (root - apart);
  if (!std::isfinite(slope)) return std::nullopt;
  return DemingLine{my - slope * mx, slope};
}

}  // namespace

Expected<DemingRegression> demingRegression(std::span<const double> x, std::span<const double> y, double errorRatio,
                                            double level) {
  if (x.size() != y.size()) return NoResult{"the two variables have different lengths"};
  if (x.size() < 4) return NoResult{"fewer than four pairs"};
  if (!allFinite(x) || !allFinite(y)) return NoResult{"a value is not finite"};
  const std::optional<DemingLine> whole = demingLine(x, y, errorRatio);
  if (!whole) return NoResult{"the slope is not determined"};
  const double n = static_cast<double>(x.size());
  std::vector<double> slopes, intercepts;
  for (std::size_t out = 0; out < x.size(); ++out) {
    std::vector<double> withoutX, withoutY;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (i == out) continue;
      withoutX.push_back(x[i]);
      withoutY.push_back(y[i]);
    }
    const std::optional<DemingLine> line = demingLine(withoutX, withoutY, errorRatio);
    if (!line) return NoResult{"one pair alone determines the slope"};
    slopes.push_back(n * whole->slope - (n - 1.0) * line->slope);
    intercepts.push_back(n * whole->intercept - (n - 1.0) * line->intercept);
  }
  DemingRegression result;
  result.pairs = x.size();
  result.slope = whole->slope;
  result.intercept = whole->intercept;
  result.slopeError = *standardDeviation(slopes) / std::sqrt(n);
  result.interceptError = *standardDeviation(intercepts) / std::sqrt(n);
  const double t = studentQuantile(0.5 + level / 2.0, n - 2.0);
  const auto around = [&](double value, double error) {
    return Interval{value - t * error, value + t * error, level, "jackknife, Student's t"};
  };
  result.slopeInterval = around(result.slope, result.slopeError);
  result.interceptInterval = around(result.intercept, result.interceptError);
  return result;
}

}  // namespace calot::analytics

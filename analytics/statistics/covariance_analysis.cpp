// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/covariance_analysis.h"

#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/least_squares.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

using Columns = std::vector<std::vector<double>>;

/// All that is left of the outcomes is rounding.
bool withoutScatter(const LeastSquares& fit, std::span<const double> outcome) {
  double squares = 0.0;
  for (const double v : outcome) squares += v * v;
  return fit.residualSumOfSquares <= 1e-26 * squares;
}

constexpr const char* noScatter = "the outcomes have no scatter about the lines";

Expected<double> slopesAgree(const Columns& columns, std::span<const double> outcome) {
  Columns more = columns;
  more.push_back(columns[2]);
  for (std::size_t i = 0; i < outcome.size(); ++i) more.back()[i] *= columns[1][i];
  const Expected<LeastSquares> fit = leastSquares(more, outcome);
  if (!fit) return Expected<double>::none(fit.reason());
  const Expected<std::vector<double>> errors = hc3Errors(*fit, more);
  if (!errors) return Expected<double>::none(errors.reason());
  if (withoutScatter(*fit, outcome) || !((*errors)[3] > 0.0)) return Expected<double>::none(noScatter);
  return studentTwoSided(fit->coefficients[3] / (*errors)[3], fit->df);
}

}  // namespace

Expected<CovarianceAnalysis> covarianceAnalysis(const BaselineGroup& x, const BaselineGroup& y, double level) {
  using Result = Expected<CovarianceAnalysis>;
  if (x.baseline.size() != x.outcome.size() || y.baseline.size() != y.outcome.size())
    return Result::none("baseline and outcome are not of the same people");
  if (const std::string reason = twoGroupObjection(x.outcome, y.outcome); !reason.empty()) return Result::none(reason);
  const std::vector<double> outcome = pooled(x.outcome, y.outcome);
  Columns columns(3, std::vector<double>(outcome.size(), 1.0));
  for (std::size_t i = x.outcome.size(); i < outcome.size(); ++i) columns[1][i] = 0.0;
  columns[2] = pooled(x.baseline, y.baseline);
  if (!allFinite(columns[2])) return Result::none("a value is not finite");
  // Centring the baseline changes nothing but improves the conditioning.
  const double centre = *mean(columns[2]);
  for (double& v : columns[2]) v -= centre;
  const Expected<LeastSquares> fit = leastSquares(columns, outcome);
  if (!fit) {
    return Result::none(fit.reason() == "the columns depend on each other"
                            ? "the baseline is constant, or the group determines it"
                            : fit.reason());
  }
  const Expected<std::vector<double>> errors = hc3Errors(*fit, columns);
  if (!errors) return Result::none(errors.reason());
  CovarianceAnalysis result;
  result.difference = fit->coefficients[1];
  result.error = (*errors)[1];
  if (withoutScatter(*fit, outcome) || !(result.error > 0.0)) return Result::none(noScatter);
  result.df = fit->df;
  result.t = result.difference / result.error;
  result.p = studentTwoSided(result.t, result.df);
  const double half = studentQuantile(0.5 + level / 2.0, result.df) * result.error;
  result.interval = {result.difference - half, result.difference + half, level, "Student's t, HC3"};
  result.slope = fit->coefficients[2];
  result.sameSlope = slopesAgree(columns, outcome);
  return result;
}

}  // namespace calot::analytics

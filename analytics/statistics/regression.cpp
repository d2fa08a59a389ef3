// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/regression.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
#include <set>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

std::vector<double> LeastSquares::standardErrors() const {
  const std::size_t p = coefficients.size();
  std::vector<double> errors(p);
  for (std::size_t j = 0; j < p; ++j) errors[j] = sigma * std::sqrt(unscaled[j * p + j]);
  return errors;
}

Expected<LeastSquares> leastSquares(const std::vector<std::vector<double>>& columns, std::span<const double> y) {
  using Eigen::Index;
  if (columns.empty()) return NoResult{"no columns"};
  for (const std::vector<double>& column : columns) {
    if (column.size() != y.size()) return NoResult{"the variables have different lengths"};
    if (!allFinite(column)) return NoResult{"a value is not finite"};
  }
  if (!allFinite(y)) return NoResult{"a value is not finite"};
  if (y.size() <= columns.size()) return NoResult{"no more values than coefficients"};
  const auto n = static_cast<Index>(y.size()), p = static_cast<Index>(columns.size());
  Eigen::MatrixXd x(n, p);
  Eigen::VectorXd scale(p);
  for (Index j = 0; j < p; ++j) {
    x.col(j) = Eigen::Map<const Eigen::VectorXd>(columns[static_cast<std::size_t>(j)].data(), n);
    scale[j] = x.col(j).norm();
    if (!(scale[j] > 0.0)) return NoResult{"the columns depend on each other"};
    x.col(j) /= scale[j];
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(x);
  qr.setThreshold(1e-10);
  if (qr.rank() < p) return NoResult{"the columns depend on each other"};
  const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(y.data(), n);
  Eigen::VectorXd b = qr.solve(right);
  // One step of refinement.
  b += qr.solve(right - x * b);
  const Eigen::VectorXd residual = right - x * b;
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, p);
  const Eigen::MatrixXd r = qr.matrixR().topLeftCorner(p, p).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd back =
      qr.colsPermutation() * r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(p, p));
  const Eigen::MatrixXd inverse = back * back.transpose();
  LeastSquares fit;
  fit.residuals.assign(residual.data(), residual.data() + n);
  fit.residualSumOfSquares = residual.squaredNorm();
  fit.df = static_cast<double>(n - p);
  fit.sigma = std::sqrt(fit.residualSumOfSquares / fit.df);
  for (Index i = 0; i < n; ++i) fit.leverages.push_back(std::min(1.0, q.row(i).squaredNorm()));
  for (Index i = 0; i < p; ++i) {
    fit.coefficients.push_back(b[i] / scale[i]);
    for (Index j = 0; j < p; ++j) fit.unscaled.push_back(inverse(i, j) / (scale[i] * scale[j]));
    fit.logDeterminant += 2.0 * (std::log(std::abs(r(i, i))) + std::log(scale[i]));
  }
  return fit;
}

ModelTerm modelTerm(double estimate, double error, double df, double level, const char* method) {
  const double t = estimate / error, half = studentQuantile(0.5 + level / 2.0, df) * error;
  return {estimate, error, t, df, studentTwoSided(t, df), {estimate - half, estimate + half, level, method}};
}

Expected<std::vector<double>> hc3Errors(const LeastSquares& fit, const std::vector<std::vector<double>>& columns) {
  const std::size_t p = columns.size();
  std::vector<double> sum(p, 0.0);
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    const double slack = 1.0 - fit.leverages[i];
    if (slack < 1e-10) return NoResult{"one value alone determines a coefficient"};
    const double weighted = fit.residuals[i] / slack;
    for (std::size_t j = 0; j < p; ++j) {
      double influence = 0.0;
      for (std::size_t k = 0; k < p; ++k) influence += fit.unscaled[j * p + k] * columns[k][i];
      sum[j] += influence * weighted * influence * weighted;
    }
  }
  for (double& s : sum) s = std::sqrt(s);
  return sum;
}

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
  if (!fit) return NoResult{fit.reason()};
  const Expected<std::vector<double>> errors = hc3Errors(*fit, more);
  if (!errors) return NoResult{errors.reason()};
  if (withoutScatter(*fit, outcome) || !((*errors)[3] > 0.0)) return NoResult{noScatter};
  return studentTwoSided(fit->coefficients[3] / (*errors)[3], fit->df);
}

}  // namespace

Expected<CovarianceAnalysis> covarianceAnalysis(const BaselineGroup& x, const BaselineGroup& y, double level) {
  if (x.baseline.size() != x.outcome.size() || y.baseline.size() != y.outcome.size())
    return NoResult{"baseline and outcome are not of the same people"};
  if (const std::string reason = twoGroupObjection(x.outcome, y.outcome); !reason.empty()) return NoResult{reason};
  const std::vector<double> outcome = pooled(x.outcome, y.outcome);
  Columns columns(3, std::vector<double>(outcome.size(), 1.0));
  for (std::size_t i = x.outcome.size(); i < outcome.size(); ++i) columns[1][i] = 0.0;
  columns[2] = pooled(x.baseline, y.baseline);
  if (!allFinite(columns[2])) return NoResult{"a value is not finite"};
  // Centring the baseline changes nothing but improves the conditioning.
  const double centre = *mean(columns[2]);
  for (double& v : columns[2]) v -= centre;
  const Expected<LeastSquares> fit = leastSquares(columns, outcome);
  if (!fit) {
    return NoResult{fit.reason() == "the columns depend on each other"
                        ? "the baseline is constant, or the group determines it"
                        : fit.reason()};
  }
  const Expected<std::vector<double>> errors = hc3Errors(*fit, columns);
  if (!errors) return NoResult{errors.reason()};
  if (withoutScatter(*fit, outcome) || !((*errors)[1] > 0.0)) return NoResult{noScatter};
  const ModelTerm group = modelTerm(fit->coefficients[1], (*errors)[1], fit->df, level, "Student's t, HC3");
  return CovarianceAnalysis{group, fit->coefficients[2], slopesAgree(columns, outcome)};
}

Expected<LearningCurve> fitLearningCurve(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) return NoResult{"attempts and values have different lengths"};
  if (!allFinite(x) || !allFinite(y)) return NoResult{"a value is not finite"};
  if (!std::all_of(x.begin(), x.end(), [](double v) { return v > 0.0; }))
    return NoResult{"an attempt's number is not positive"};
  constexpr std::size_t parameters = 2;
  if (std::set<double>(x.begin(), x.end()).size() < parameters || y.size() <= parameters)
    return NoResult{"too few attempts for the curve"};
  if (std::all_of(y.begin(), y.end(), [&](double v) { return v == y.front(); }))
    return NoResult{"all values are equal"};
  std::vector<std::vector<double>> columns(2, std::vector<double>(x.size(), 1.0));
  for (std::size_t i = 0; i < x.size(); ++i) columns[1][i] = -1.0 / x[i];
  const Expected<LeastSquares> fit = leastSquares(columns, y);
  if (!fit) return NoResult{fit.reason()};
  const std::vector<double> errors = fit->standardErrors();
  LearningCurve curve;
  curve.plateau = fit->coefficients[0];
  curve.gap = fit->coefficients[1];
  curve.plateauError = errors[0];
  curve.gapError = errors[1];
  curve.residualSumOfSquares = fit->residualSumOfSquares;
  curve.sigma = fit->sigma;
  curve.covariance = fit->sigma * fit->sigma * fit->unscaled[1];
  curve.freedom = y.size() - parameters;
  return curve;
}

Interval bandOf(const LearningCurve& curve, double x, double level) {
  const double variance =
      curve.plateauError * curve.plateauError - 2.0 * curve.covariance / x + curve.gapError * curve.gapError / (x * x);
  const double half =
      studentQuantile(0.5 + 0.5 * level, static_cast<double>(curve.freedom)) * std::sqrt(std::max(0.0, variance));
  return Interval{curve.at(x) - half, curve.at(x) + half, level, "Student's t of a linear fit, pointwise"};
}

}  // namespace calot::analytics

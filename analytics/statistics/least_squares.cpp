// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/least_squares.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>

#include "analytics/statistics/samples.h"

namespace calot::analytics {

std::vector<double> LeastSquares::standardErrors() const {
  const std::size_t p = coefficients.size();
  std::vector<double> errors(p);
  for (std::size_t j = 0; j < p; ++j) errors[j] = sigma * std::sqrt(unscaled[j * p + j]);
  return errors;
}

Expected<LeastSquares> leastSquares(const std::vector<std::vector<double>>& columns, std::span<const double> y) {
  using Result = Expected<LeastSquares>;
  using Eigen::Index;
  if (columns.empty()) return Result::none("no columns");
  for (const std::vector<double>& column : columns) {
    if (column.size() != y.size()) return Result::none("the variables have different lengths");
    if (!allFinite(column)) return Result::none("a value is not finite");
  }
  if (!allFinite(y)) return Result::none("a value is not finite");
  if (y.size() <= columns.size()) return Result::none("no more values than coefficients");
  const auto n = static_cast<Index>(y.size()), p = static_cast<Index>(columns.size());
  Eigen::MatrixXd x(n, p);
  Eigen::VectorXd scale(p);
  for (Index j = 0; j < p; ++j) {
    x.col(j) = Eigen::Map<const Eigen::VectorXd>(columns[static_cast<std::size_t>(j)].data(), n);
    scale[j] = x.col(j).norm();
    if (!(scale[j] > 0.0)) return Result::none("the columns depend on each other");
    x.col(j) /= scale[j];
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(x);
  qr.setThreshold(1e-10);
  if (qr.rank() < p) return Result::none("the columns depend on each other");
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

Expected<std::vector<double>> hc3Errors(const LeastSquares& fit, const std::vector<std::vector<double>>& columns) {
  const std::size_t p = columns.size();
  std::vector<double> sum(p, 0.0);
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    const double slack = 1.0 - fit.leverages[i];
    if (slack < 1e-10) return Expected<std::vector<double>>::none("one value alone determines a coefficient");
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

}  // namespace calot::analytics

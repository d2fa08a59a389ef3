// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/complementarity.h"

#include <algorithm>
#include <cmath>

namespace calot {

namespace {

double gapOf(std::span<const double> compliance, std::span<const double> free, std::span<const double> lambda,
             std::size_t i) {
  const std::size_t n = free.size();
  double gap = free[i];
  for (std::size_t j = 0; j < n; ++j) gap += compliance[i * n + j] * lambda[j];
  return gap;
}

double residualOf(std::span<const double> compliance, std::span<const double> free, std::span<const double> lambda) {
  double residual = 0.0;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const double force = compliance[i * free.size() + i] * lambda[i];
    residual = std::max(residual, std::abs(std::min(force, gapOf(compliance, free, lambda, i))));
  }
  return residual;
}

/// Forces that close the gaps of the active rows, by Cholesky. @returns the row that depends on the ones before it, or
/// the number of active rows.
std::size_t closeGaps(std::span<const double> compliance, std::span<const double> free,
                      const std::vector<std::size_t>& active, std::vector<double>& factor, std::vector<double>& x) {
  const std::size_t n = free.size();
  const std::size_t m = active.size();
  factor.assign(m * m, 0.0);
  x.assign(m, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    const std::size_t row = active[i] * n;
    for (std::size_t j = 0; j < i; ++j) {
      double v = compliance[row + active[j]];
      for (std::size_t k = 0; k < j; ++k) v -= factor[i * m + k] * factor[j * m + k];
      factor[i * m + j] = v / factor[j * m + j];
    }
    double v = compliance[row + active[i]];
    for (std::size_t k = 0; k < i; ++k) v -= factor[i * m + k] * factor[i * m + k];
    if (!(v > 1e-10 * compliance[row + active[i]])) return i;
    factor[i * m + i] = std::sqrt(v);
  }
  for (std::size_t i = 0; i < m; ++i) {
    double v = -free[active[i]];
    for (std::size_t k = 0; k < i; ++k) v -= factor[i * m + k] * x[k];
    x[i] = v / factor[i * m + i];
  }
  for (std::size_t i = m; i-- > 0;) {
    double v = x[i];
    for (std::size_t k = i + 1; k < m; ++k) v -= factor[k * m + i] * x[k];
    x[i] = v / factor[i * m + i];
  }
  return m;
}

/// @returns the number of exchanges; lambda is replaced by the best that was met, if it is better.
std::uint32_t pivot(std::span<const double> compliance, std::span<const double> free, std::span<double> lambda,
                    double tolerance, double& residual) {
  const std::size_t n = free.size();
  std::vector<bool> in(n);
  for (std::size_t i = 0; i < n; ++i) in[i] = lambda[i] > 0.0;
  std::vector<std::size_t> active;
  std::vector<double> factor;
  std::vector<double> x;
  std::vector<double> trial(n);
  const auto most = static_cast<std::uint32_t>(10 * n + 20);
  for (std::uint32_t exchanges = 0;; ++exchanges) {
    active.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (in[i]) active.push_back(i);
    }
    for (std::size_t dependent = 0; (dependent = closeGaps(compliance, free, active, factor, x)) < active.size();) {
      in[active[dependent]] = false;
      active.erase(active.begin() + static_cast<std::ptrdiff_t>(dependent));
    }
    std::fill(trial.begin(), trial.end(), 0.0);
    for (std::size_t k = 0; k < active.size(); ++k) trial[active[k]] = x[k];
    std::size_t wrong = n;
    for (std::size_t i = 0; i < n && wrong == n; ++i) {
      if (in[i] ? trial[i] < 0.0 : gapOf(compliance, free, trial, i) < -0.5 * tolerance) wrong = i;
    }
    for (double& t : trial) t = std::max(t, 0.0);
    const double reached = residualOf(compliance, free, trial);
    if (reached < residual) {
      residual = reached;
      std::copy(trial.begin(), trial.end(), lambda.begin());
    }
    if (wrong == n || residual <= tolerance || exchanges >= most) return exchanges;
    in[wrong] = !in[wrong];
  }
}

}  // namespace

ComplementarityReport solveComplementarity(std::span<const double> compliance, std::span<const double> free,
                                           std::span<double> lambda, double tolerance, std::uint32_t cap,
                                           Finish finish) {
  const std::size_t n = free.size();
  for (double& l : lambda) l = std::max(l, 0.0);
  ComplementarityReport report;
  for (;;) {
    report.residual = residualOf(compliance, free, lambda);
    if (report.residual <= tolerance || report.sweeps >= cap) break;
    for (std::size_t i = 0; i < n; ++i) {
      lambda[i] = std::max(0.0, lambda[i] - gapOf(compliance, free, lambda, i) / compliance[i * n + i]);
    }
    ++report.sweeps;
  }
  if (report.residual > tolerance && finish == Finish::pivoting) {
    report.pivots = pivot(compliance, free, lambda, tolerance, report.residual);
  }
  report.converged = report.residual <= tolerance;
  return report;
}

}  // namespace calot

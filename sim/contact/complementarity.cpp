// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/complementarity.h"

#include <algorithm>
#include <cmath>

namespace calot {

ComplementarityReport solveComplementarity(std::span<const double> compliance, std::span<const double> free,
                                           std::span<double> lambda, double tolerance, std::uint32_t cap) {
  const std::size_t n = free.size();
  for (double& l : lambda) l = std::max(l, 0.0);
  const auto gapOf = [&](std::size_t i) {
    double gap = free[i];
    for (std::size_t j = 0; j < n; ++j) gap += compliance[i * n + j] * lambda[j];
    return gap;
  };
  ComplementarityReport report;
  for (;;) {
    report.residual = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      report.residual = std::max(report.residual, std::abs(std::min(compliance[i * n + i] * lambda[i], gapOf(i))));
    }
    report.converged = report.residual <= tolerance;
    if (report.converged || report.sweeps >= cap) return report;
    for (std::size_t i = 0; i < n; ++i) {
      lambda[i] = std::max(0.0, lambda[i] - gapOf(i) / compliance[i * n + i]);
    }
    ++report.sweeps;
  }
}

}  // namespace calot

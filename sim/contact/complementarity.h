// SPDX-License-Identifier: GPL-3.0-or-later
// The linear complementarity problem of frictionless contact: find lambda >= 0 with gap = W lambda + free >= 0 and
// lambda . gap = 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace calot {

struct ComplementarityReport {
  std::uint32_t sweeps = 0;
  double residual = 0.0;  ///< largest |min(W_ii lambda_i, gap_i)| (m)
  bool converged = true;
};

/// Projected Gauss-Seidel (Jourdan, Alart and Jean 1998 without friction): sweeps over the rows in order until the
/// residual is at most `tolerance` or `cap` sweeps are done.
/// @param compliance W, row-major, n x n, positive diagonal (m/N)
/// @param free gaps without any force (m)
/// @param lambda in: warm start (negative values count as 0); out: forces (N)
ComplementarityReport solveComplementarity(std::span<const double> compliance, std::span<const double> free,
                                           std::span<double> lambda, double tolerance, std::uint32_t cap);

}  // namespace calot

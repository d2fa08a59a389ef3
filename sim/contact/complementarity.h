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
  std::uint32_t pivots = 0;
  double residual = 0.0;  ///< largest |min(W_ii lambda_i, gap_i)| (m)
  bool converged = true;
};

/// Where sweeps alone do not converge (rows that nearly repeat each other), the active set is searched.
enum class Finish : std::uint8_t {
  sweeps,    ///< no; bounded time, for the haptic tick
  pivoting,  ///< yes
};

/// Projected Gauss-Seidel (Jourdan, Alart and Jean 1998, without friction): sweeps over the rows in order until the
/// residual is at most `tolerance` or `cap` sweeps are done; then, if asked for, least-index principal pivoting (Murty
/// 1974) from the active set that the sweeps found, at most 10 n + 20 exchanges, kept where its residual is smaller.
/// @param compliance W, row-major, n x n, symmetric, positive diagonal (m/N)
/// @param free gaps without any force (m)
/// @param lambda in: warm start (negative values count as 0); out: forces (N)
ComplementarityReport solveComplementarity(std::span<const double> compliance, std::span<const double> free,
                                           std::span<double> lambda, double tolerance, std::uint32_t cap,
                                           Finish finish = Finish::pivoting);

}  // namespace calot

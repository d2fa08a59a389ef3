// SPDX-License-Identifier: GPL-3.0-or-later
// The contact problem by plain dense methods: the peers of sim/contact/contact_solver.h. Shares no code with it.
#pragma once

#include <vector>

#include "sim/contact/contact_solver.h"

namespace calot::bench {

/// A contact problem that owns its arrays.
struct OwnedProblem {
  std::vector<BlockKind> kind;
  std::vector<double> limit;
  std::vector<double> compliance;
  std::vector<double> free;

  [[nodiscard]] ContactProblem view() const { return {kind, limit, compliance, free}; }
};

/// Unilateral rows to machine precision by block principal pivoting with a dense factorisation a pivot (Judice and
/// Pires 1994, "A block principal pivoting algorithm for large-scale strictly monotone linear complementarity
/// problems"): what a direct solver of the complementarity problem does.
/// @pre all blocks are unilateral
std::vector<double> principalPivoting(const OwnedProblem& problem, int& pivots);

/// Unilateral and frictional blocks by the projected fixed point lambda = P(lambda - gap / s), s a bound on the largest
/// eigenvalue, to `tolerance` (m): slow and sure, the reference for errors.
/// @return empty where it does not get there
std::vector<double> projectedFixedPoint(const OwnedProblem& problem, double tolerance);

}  // namespace calot::bench

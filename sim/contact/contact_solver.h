// SPDX-License-Identifier: GPL-3.0-or-later
// The complementarity problem of unilateral contact with Coulomb friction and of
// bilateral constraints (grasped tissue).
//
// Gaps depend linearly on forces: gap(lambda) = W lambda + free. Rows come in blocks:
//   unilateral  1 row   0 <= lambda  _|_  gap >= 0
//   frictional  3 rows  the first as above; the other two, tangential slip, with |lambda_t| <= mu lambda_n and slip
//                       against the force where that bound is reached (Coulomb; De Saxce and Feng 1998)
//   bilateral   3 rows  gap = 0 as long as |lambda| <= limit; at the limit, the point slips
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace calot {

enum class BlockKind : std::uint8_t { unilateral = 0, frictional = 1, bilateral = 2 };

constexpr std::size_t blockRows(BlockKind kind) { return kind == BlockKind::unilateral ? 1 : 3; }

/// Spans into the caller's arrays. n rows in blocks, in order.
struct ContactProblem {
  std::span<const BlockKind> kind;
  std::span<const double> limit;       ///< per block: friction coefficient (frictional), force (bilateral, N)
  std::span<const double> compliance;  ///< W, row-major, n x n, symmetric, positive diagonal (m/N)
  std::span<const double> free;        ///< gaps and slips without any force (m)
};

struct ContactReport {
  std::uint32_t sweeps = 0;
  std::uint32_t newtonSteps = 0;
  double residual = 0.0;  ///< largest natural residual of a block (m), see naturalResidual
  bool converged = true;
};

/// Largest over the blocks of |F| with the natural map F: lambda that solve the problem are its zeros.
///   unilateral  min(W_ii lambda, gap)
///   otherwise   s lambda - P(s lambda - gap) for the projection P onto s times the friction disc or the ball,
///               s the mean of the block's (tangential) diagonal
/// @param gap W lambda + free
double naturalResidual(const ContactProblem& problem, std::span<const double> lambda, std::span<const double> gap);

/// Solves by block Gauss-Seidel with exact local solves (Jourdan, Alart and Jean 1998) from a warm start, until the
/// residual is at most `tolerance` or `cap` sweeps are done. Gaps are updated column by column: a row costs O(n) when
/// its force changes and nothing while it stays open. Allocates nothing.
/// @param lambda in: warm start, projected onto the admissible set; out: forces (N)
/// @param gap out: W lambda + free (m); n values
ContactReport sweepContacts(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap,
                            double tolerance, std::uint32_t cap);

/// Runs sweeps. If they do not converge (nearly dependent rows), it takes up to `maxNewtonSteps` semi-smooth Newton
/// steps on the natural map (Alart and Curnier 1991) with a line search and returns the best iterate. Rounding can make
/// W indefinite when rows are dependent, and both methods may then diverge: a result whose residual exceeds 1000 times
/// that of the warm start is rejected in favour of the warm start.
class ContactSolver {
 public:
  static constexpr std::uint32_t maxNewtonSteps = 20;
  ContactReport solve(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap, double tolerance,
                      std::uint32_t cap);

 private:
  void newton(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap, double tolerance,
              ContactReport& report);
  bool direction(const ContactProblem& problem, std::span<const double> lambda, std::span<const double> gap);

  std::vector<double> start_, matrix_, right_, trial_, trialGap_;
};

/// Projects a block's forces onto its admissible set.
void projectOntoFrictionCone(BlockKind kind, double limit, std::span<double> lambda);

/// gap = W lambda + free, column by column.
void evaluateGaps(const ContactProblem& problem, std::span<const double> lambda, std::span<double> gap);

}  // namespace calot

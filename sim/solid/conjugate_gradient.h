// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients preconditioned by a symmetric Gauss-Seidel sweep (Saad 2003, section 10.2) on BlockMatrix, at the
// price of one multiplication an iteration (Eisenstat 1981). With A = L + D + L^T + E, in the order of the colours, the
// iteration runs on (D + L)^-1 A (D + L)^-T, which is applied to p by two sweeps over L:
//   t = (D + L)^-T p,   s = (D + L)^-1 (p - D t + E t),   result t + s.
// Going back, each row hands what it has found on to the rows before it, so that L alone is stored. Always from a zero
// start, so that no warm start belongs to State and a cap that binds cannot make the iteration grow. Matrix and vectors
// are float, sums are double, in an order fixed by the matrix. One thread: a sweep of a thousand rows takes less time
// than handing its colours on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/solid/block_matrix.h"

namespace calot {

class CoarseLattice;

namespace sweeps {
struct Slices;
}

struct SolveReport {
  std::uint32_t iterations = 0;
  /// |r| / |b| by the recursion, in the norm of the preconditioner's inverse, largest over the right-hand sides: near
  /// to the relative error in the norm of energy. Where b is less than what the tolerance is counted from
  /// (SolveGoal::from()), |r| over that.
  double residual = 0.0;
  bool converged = true;
};

/// When a solve ends: |r| <= max(tolerance |b|, least), in the norm of SolveReport.
struct SolveGoal {
  double tolerance = 1e-4;
  std::uint32_t cap = 200;  ///< of iterations
  double least = 0.0;       ///< what is less is not worth an iteration (kg^1/2 m/s, for b in N s)

  /// The square of what the tolerance is counted from where b is less.
  [[nodiscard]] double from() const { return least > 0.0 ? (least / tolerance) * (least / tolerance) : 0.0; }
};

class ConjugateGradient {
 public:
  /// Inverts the diagonal blocks.
  /// @param extra E: belong to the matrix as well, a few; kept for the solves
  /// @pre the diagonal blocks are positive definite.
  void prepare(const BlockMatrix& matrix, std::span<const float> values, std::span<const ExtraBlock> extra = {});

  /// Solves A x = b until the residual of SolveReport is at most the tolerance. Layout of b and x: BlockMatrix vectors.
  /// @pre prepare() was called with these values.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                    std::span<float> x, const SolveGoal& wanted);

  /// The same with a lattice beside the sweeps, which then cost half a multiplication more each: large solids need a
  /// fraction of the iterations. The residual is in the norm of both.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, CoarseLattice& lattice,
                    std::span<const float> b, std::span<float> x, const SolveGoal& wanted);

  /// Eight right-hand sides at once: component i of row r of vector k stands at 24 r + 8 i + k. Zero ones cost nothing
  /// extra and stay zero. What becomes of one does not depend on the others.
  SolveReport solveMany(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                        std::span<float> x, double tolerance, std::uint32_t cap);

 private:
  /// Sets the vectors of a solve to nothing.
  void clear(std::size_t size);
  [[nodiscard]] sweeps::Slices slicesOf(const BlockMatrix& matrix, std::span<const float> values) const;
  void addExtra();
  void addExtraMany();

  std::vector<float> inverse_;  ///< 3x3 inverse diagonal blocks: per slice 9 x 8 lanes
  std::vector<ExtraBlock> extra_;
  std::vector<float> r_, z_, p_, t_, s_;
  std::vector<float> u_, sRows_;            ///< u, and of one right-hand side a copy of s, by rows
  std::vector<float> q_, y_, c_, uw_, pq_;  ///< with a lattice: lattice_gradient.cpp
};

}  // namespace calot

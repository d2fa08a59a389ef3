// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients with a block-diagonal preconditioner (Shewchuk 1994; Saad 2003, algorithm 9.1) on BlockMatrix,
// always from a zero start, so that no warm start belongs to State and a cap that binds cannot make the iteration grow.
// Matrix and vectors are float, sums are double, in an order fixed by the matrix: any number of threads gives the same
// bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/solid/block_matrix.h"

namespace calot {

struct SolveReport {
  std::uint32_t iterations = 0;
  double residual = 0.0;  ///< |r| / |b| by the recursion, largest over the right-hand sides
  bool converged = true;
};

class ConjugateGradient {
 public:
  /// Inverts the diagonal blocks. @param diagonal position of the diagonal block among the columns of each row.
  /// @param extra belong to the matrix as well: a few, applied one after the other; kept for the solves
  /// @pre the diagonal blocks are positive definite.
  void prepare(const BlockMatrix& matrix, std::span<const float> values, std::span<const int> diagonal,
               Executor& executor, std::span<const ExtraBlock> extra = {});

  /// Solves A x = b to |r| <= tolerance |b|. Layout of b and x: BlockMatrix vectors. @pre prepare() was called.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                    std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor);

  /// Eight right-hand sides at once (layout of multiplyMany); zero ones cost nothing extra and stay zero.
  SolveReport solveMany(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                        std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor);

 private:
  double addExtra();
  void addExtraMany(std::array<double, laneCount>& dot);

  std::vector<float> inverse_;  ///< 3x3 inverse diagonal blocks: per slice 9 x 8 lanes
  std::vector<ExtraBlock> extra_;
  std::vector<float> r_, p_, y_, z_;
  std::vector<std::array<double, 2>> partial_;
  std::vector<std::array<double, 2 * laneCount>> partialMany_;
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients preconditioned by a symmetric Gauss-Seidel sweep (Saad 2003, section 10.2) on BlockMatrix, at the
// price of one multiplication an iteration (Eisenstat 1981). With A = L + D + L^T + E, in the order of the colours, the
// iteration runs on (D + L)^-1 A (D + L)^-T, which is applied to p by two sweeps:
//   t = (D + L)^-T p,   s = (D + L)^-1 (p - D t + E t),   result t + s,
// each over one half of the matrix. Always from a zero start, so that no warm start belongs to State and a cap that
// binds cannot make the iteration grow. Matrix and vectors are float, sums are double, in an order fixed by the matrix:
// any number of threads gives the same bits.
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
  /// |r| / |b| by the recursion, in the norm of the preconditioner's inverse, largest over the right-hand sides: near
  /// to the relative error in the norm of energy.
  double residual = 0.0;
  bool converged = true;
};

class ConjugateGradient {
 public:
  /// Inverts the diagonal blocks.
  /// @param extra E: belong to the matrix as well, a few; kept for the solves
  /// @pre the diagonal blocks are positive definite.
  void prepare(const BlockMatrix& matrix, std::span<const float> values, Executor& executor,
               std::span<const ExtraBlock> extra = {});

  /// Solves A x = b until the residual of SolveReport is at most `tolerance`. Layout of b and x: BlockMatrix vectors.
  /// @pre prepare() was called with these values.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                    std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor);

  /// Eight right-hand sides at once: component i of row r of vector k stands at 24 r + 8 i + k. Zero ones cost nothing
  /// extra and stay zero.
  SolveReport solveMany(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                        std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor);

 private:
  /// Slices of one colour that one task takes.
  struct Piece {
    std::size_t first, last;
  };
  using Eight = std::array<double, laneCount>;

  /// Calls slices(piece) for every piece; colours one after the other, ascending or descending, where `ordered`.
  enum class Order : std::uint8_t { any, ascending, descending };
  template <class F>
  void run(Order order, Executor& executor, F&& slices) const;
  /// Sets the vectors of a solve to nothing.
  void clear(std::size_t size);
  void addExtra();
  void addExtraMany();

  std::vector<float> inverse_;  ///< 3x3 inverse diagonal blocks: per slice 9 x 8 lanes
  std::vector<ExtraBlock> extra_;
  std::vector<Piece> piece_;
  std::vector<std::size_t> colourPiece_;  ///< first piece of each colour, and the end
  std::vector<float> r_, z_, p_, t_, u_, s_;
  std::vector<Eight> partial_;  ///< per piece and lane
};

}  // namespace calot

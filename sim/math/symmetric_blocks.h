// SPDX-License-Identifier: GPL-3.0-or-later
// Direct solution of A x = b, A sparse, symmetric and positive definite, of 3 x 3 blocks: block Cholesky in an order of
// least degree (Tinney and Walker 1967; ties go to the smaller row). For systems that are solved once, such as those of
// a Model, to full accuracy in double.
//
// With rows numbered in the order of their elimination:
//   L_kk L_kk^T = A_kk,   L_ik = A_ik L_kk^-T,   A_ij -= L_ik L_jk^T   for i >= j > k.
// Cost: the sum over rows of the squared number of later rows that they meet. Bodies of 2,500 nodes in three dimensions
// take 0.1 s, the square of that factor for more.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

class SymmetricBlocks {
 public:
  explicit SymmetricBlocks(std::size_t rows) : row_(rows) {}

  [[nodiscard]] std::size_t rows() const { return row_.size(); }
  /// Adds to block (i, j) and its transpose to (j, i); to a diagonal block once. @pre a diagonal block is symmetric
  void add(std::size_t i, std::size_t j, const Mat3& block);

  /// Factorises what was added; to be called once, before solve(). A pivot below `singular` of its diagonal entry has
  /// nothing that holds it: that unknown is fixed at zero.
  /// @return how many unknowns were fixed
  std::size_t factor();

  /// x with A x = b, refined until the residual b - A x no longer falls. @pre factor()
  [[nodiscard]] std::vector<Vec3> solve(std::span<const Vec3> b) const;
  /// A x
  [[nodiscard]] std::vector<Vec3> times(std::span<const Vec3> x) const;

  static constexpr double singular = 1e-11;

 private:
  void order();
  void substitute(std::vector<Vec3>& x) const;

  std::vector<std::map<std::size_t, Mat3>> row_;  ///< A: the lower triangle and the diagonal
  std::vector<std::size_t> eliminated_;           ///< row that is the k-th to be eliminated
  std::vector<std::vector<std::size_t>> below_;   ///< per column of L: its rows below the diagonal, ascending
  std::vector<std::vector<Mat3>> lower_;          ///< its blocks
  std::vector<Mat3> diagonal_;                    ///< L_kk^-1
};

/// Inverts a symmetric positive definite matrix in place by Cholesky (Golub and Van Loan 2013, 4.2), in an order that
/// the source fixes. Intended for a few dozen rows.
/// @param a row-major, n * n numbers; only the lower triangle is read; the result is exactly symmetric
/// @return false, with `a` undefined, if it is not positive definite or not finite
bool invertPositive(std::span<double> a, std::size_t n);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Direct solution of A x = b where A is symmetric, positive definite, of 6 x 6 blocks, and its graph is a forest: a
// chain (block-tridiagonal) or branching chains. Eliminating every node before its parent fills nothing in, so block
// Cholesky is exact and linear in the number of nodes.
//
// With A_i the diagonal block of node i, B_i = A_{i,p} its block in the column of its parent p, from the last
// node to the first:
//   L_i L_i^T = A_i,   W_i = L_i^-1 B_i,   A_p -= W_i^T W_i.
// Scalar loops in an order fixed by the source.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

/// 6 x 6 block, row-major: translation (0 to 2), then rotation (3 to 5).
using Block6 = std::array<double, 36>;
using Vector6 = std::array<double, 6>;

class BlockTree {
 public:
  /// Three columns of one node's block row and one of padding.
  using Columns = std::array<double, 24>;

  /// Sets all blocks to zero. Allocates only when the number of nodes grows. @param nodes rows of the system
  void reset(std::size_t nodes);

  /// A_i, to be filled before factor().
  [[nodiscard]] Block6& diagonal(std::size_t node) { return diagonal_[node]; }
  /// B_i, to be filled before factor(); stays zero for a root.
  [[nodiscard]] Block6& coupling(std::size_t node) { return coupling_[node]; }

  /// Factorises in place. @param parent per node: a smaller index, or -1
  /// @return false if a pivot was not positive and finite: that unknown is then fixed at zero.
  bool factor(std::span<const int> parent);

  /// Solves in place. @pre factor(); x.size() is the number of nodes
  void solve(std::span<const int> parent, std::span<Vector6> x) const;

  /// A_i'^-1 and A_i'^-1 B_i, with A_i' what elimination of a node's children left of its A_i. @pre factor()
  void eliminate(std::size_t node, Block6& inverse, Block6& gain) const;

  /// Translations of all nodes for unit right-hand sides on the three translations of one node: out[9 a + 3 i + k] is
  /// component i at node a for direction k. @pre factor(). @param out 9 numbers for each node
  void columns(std::span<const int> parent, std::size_t node, std::span<double> out);

 private:
  std::vector<Block6> diagonal_;  ///< after factor(): L_i, reciprocals on its diagonal
  std::vector<Block6> coupling_;  ///< after factor(): W_i
  std::vector<Columns> work_;
};

// A factorised BlockTree for many right-hand sides on a few nodes, in floats: for products within an iterative solve,
// whose vectors are floats.

/// Response of some nodes' translations to impulses on the same nodes. With A_i' what elimination of a node's
/// children left of A_i, and G_i = A_i'^-1 B_i:
///   y_p -= G_i^T y_i from the last node to the first, then x_i = A_i'^-1 y_i - G_i x_p.
/// Products alone, where BlockTree::solve() substitutes number after number. Nodes with none of those below them take
/// no part.
class TreeResponse {
 public:
  /// @param tree after BlockTree::factor() @param parent of its nodes @param touched ascending
  void precompute(const BlockTree& tree, std::span<const int> parent, std::span<const std::uint32_t> touched);

  /// @param push impulses in, response out: three numbers for each touched node @pre precompute()
  void solve(std::span<FourFloats> push);

 private:
  /// Translation, padding, rotation, padding.
  using Motion = std::array<float, 8>;
  using Columns = std::array<Motion, 6>;
  struct Node {
    Columns inverse;           ///< columns of A_i'^-1
    Columns up;                ///< rows of G_i
    Columns down;              ///< columns of G_i
    std::int32_t parent = -1;  ///< among those that take part
  };

  static void sumOf(const Columns& columns, const Motion& x, EightFloats& sum);
  static void solveNodes(std::span<const Node> node, std::span<Motion> x);

  std::vector<Node> node_;
  std::vector<std::int32_t> number_;    ///< per node of the tree: among those that take part, or -1
  std::vector<std::uint32_t> touched_;  ///< among those that take part
  std::vector<Motion> x_;
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// A factorised BlockTree for many right-hand sides on a few nodes, in floats: for products within an iterative solve,
// whose vectors are floats.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/vectors.h"
#include "sim/vessel/block_tree.h"

namespace calot {

/// How the translations of some nodes answer to impulses on the same nodes. With A_i' what elimination of a node's
/// children left of A_i, and G_i = A_i'^-1 B_i:
///   y_p -= G_i^T y_i from the last node to the first, then x_i = A_i'^-1 y_i - G_i x_p.
/// Products alone, where BlockTree::solve() substitutes number after number. Nodes with none of those below them take
/// no part.
class TreeResponse {
 public:
  /// @param tree after BlockTree::factor() @param parent of its nodes @param touched ascending
  void prepare(const BlockTree& tree, std::span<const int> parent, std::span<const std::uint32_t> touched);

  /// @param push in, answer out: three numbers for each touched node @pre prepare()
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

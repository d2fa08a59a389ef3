// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/tree_response.h"

namespace calot {

void TreeResponse::prepare(const BlockTree& tree, std::span<const int> parent, std::span<const std::uint32_t> touched) {
  number_.assign(parent.size(), -1);
  for (const std::uint32_t n : touched) {
    for (int at = static_cast<int>(n); at >= 0 && number_[static_cast<std::size_t>(at)] < 0;) {
      number_[static_cast<std::size_t>(at)] = 0;
      at = parent[static_cast<std::size_t>(at)];
    }
  }
  node_.clear();
  Block6 inverse;
  Block6 gain;
  for (std::size_t n = 0; n < parent.size(); ++n) {
    if (number_[n] < 0) continue;
    number_[n] = static_cast<std::int32_t>(node_.size());
    Node& node = node_.emplace_back();
    node.parent = parent[n] < 0 ? -1 : number_[static_cast<std::size_t>(parent[n])];
    tree.eliminate(n, inverse, gain);
    for (std::size_t k = 0; k < 6; ++k) {
      for (std::size_t half = 0; half < 2; ++half) {
        FourFloats column{};
        FourFloats row{};
        FourFloats across{};
        for (std::size_t i = 0; i < 3; ++i) {
          column[i] = static_cast<float>(inverse[6 * (3 * half + i) + k]);
          row[i] = static_cast<float>(gain[6 * k + 3 * half + i]);
          across[i] = static_cast<float>(gain[6 * (3 * half + i) + k]);
        }
        node.inverse[k][half] = column;
        node.up[k][half] = row;
        node.down[k][half] = across;
      }
    }
  }
  touched_.clear();
  for (const std::uint32_t n : touched) touched_.push_back(static_cast<std::uint32_t>(number_[n]));
  x_.resize(node_.size());
}

/// Sum of x's six numbers times the columns.
CALOT_INLINE TreeResponse::Pair TreeResponse::sumOf(const std::array<Pair, 6>& columns, const Pair& x) {
  Pair sum;
  for (std::size_t half = 0; half < 2; ++half) {
    const FourFloats moved = (x[0][0] * columns[0][half] + x[0][1] * columns[1][half]) + x[0][2] * columns[2][half];
    const FourFloats turned = (x[1][0] * columns[3][half] + x[1][1] * columns[4][half]) + x[1][2] * columns[5][half];
    sum[half] = moved + turned;
  }
  return sum;
}

void TreeResponse::solve(std::span<FourFloats> push) {
  for (Pair& x : x_) x = Pair{};
  for (std::size_t k = 0; k < touched_.size(); ++k) x_[touched_[k]][0] = push[k];
  for (std::size_t i = node_.size(); i-- > 0;) {
    const Node& node = node_[i];
    const Pair y = x_[i];
    x_[i] = sumOf(node.inverse, y);
    if (node.parent < 0) continue;
    Pair& above = x_[static_cast<std::size_t>(node.parent)];
    const Pair passed = sumOf(node.up, y);
    for (std::size_t half = 0; half < 2; ++half) above[half] -= passed[half];
  }
  for (std::size_t i = 0; i < node_.size(); ++i) {
    const Node& node = node_[i];
    if (node.parent < 0) continue;
    const Pair followed = sumOf(node.down, x_[static_cast<std::size_t>(node.parent)]);
    for (std::size_t half = 0; half < 2; ++half) x_[i][half] -= followed[half];
  }
  for (std::size_t k = 0; k < touched_.size(); ++k) push[k] = x_[touched_[k]][0];
}

}  // namespace calot

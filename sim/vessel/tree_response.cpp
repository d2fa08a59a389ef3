// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/tree_response.h"

#include "sim/math/lanes.h"

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
    const auto placeOf = [](std::size_t component) { return component < 3 ? component : component + 1; };
    for (std::size_t k = 0; k < 6; ++k) {
      node.inverse[k] = node.up[k] = node.down[k] = Motion{};
      for (std::size_t i = 0; i < 6; ++i) {
        node.inverse[k][placeOf(i)] = static_cast<float>(inverse[6 * i + k]);
        node.up[k][placeOf(i)] = static_cast<float>(gain[6 * k + i]);
        node.down[k][placeOf(i)] = static_cast<float>(gain[6 * i + k]);
      }
    }
  }
  touched_.clear();
  for (const std::uint32_t n : touched) touched_.push_back(static_cast<std::uint32_t>(number_[n]));
  x_.resize(node_.size());
}

/// Sum of x's six numbers times the columns.
CALOT_INLINE void TreeResponse::sumOf(const Columns& columns, const Motion& x, EightFloats& sum) {
  EightFloats column[6];
  for (std::size_t k = 0; k < 6; ++k) readVector(columns[k].data(), column[k]);
  const EightFloats moved = (x[0] * column[0] + x[1] * column[1]) + x[2] * column[2];
  const EightFloats turned = (x[4] * column[3] + x[5] * column[4]) + x[6] * column[5];
  sum = moved + turned;
}

CALOT_LANE_KERNEL void TreeResponse::solveNodes(std::span<const Node> node, std::span<Motion> x) {
  EightFloats own;
  EightFloats sum;
  for (std::size_t i = node.size(); i-- > 0;) {
    const Motion y = x[i];
    sumOf(node[i].inverse, y, own);
    writeVector(own, x[i].data());
    if (node[i].parent < 0) continue;
    Motion& above = x[static_cast<std::size_t>(node[i].parent)];
    sumOf(node[i].up, y, sum);
    readVector(above.data(), own);
    own -= sum;
    writeVector(own, above.data());
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (node[i].parent < 0) continue;
    sumOf(node[i].down, x[static_cast<std::size_t>(node[i].parent)], sum);
    readVector(x[i].data(), own);
    own -= sum;
    writeVector(own, x[i].data());
  }
}

void TreeResponse::solve(std::span<FourFloats> push) {
  for (Motion& x : x_) x.fill(0.0F);
  for (std::size_t k = 0; k < touched_.size(); ++k) writeVector(push[k], x_[touched_[k]].data());
  solveNodes(node_, x_);
  for (std::size_t k = 0; k < touched_.size(); ++k) readVector(x_[touched_[k]].data(), push[k]);
}

}  // namespace calot

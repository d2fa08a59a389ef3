// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/math/vectors.h"

namespace calot {

namespace {

using Columns = BlockTree::Columns;

/// Lower Cholesky factor in place, reciprocals on the diagonal.
bool factorBlock(Block6& a) {
  bool positive = true;
  for (std::size_t j = 0; j < 6; ++j) {
    double pivot = a[7 * j];
    for (std::size_t k = 0; k < j; ++k) pivot -= a[6 * j + k] * a[6 * j + k];
    const bool sound = pivot > 0.0 && pivot < 1e300;
    positive = positive && sound;
    const double inverse = sound ? 1.0 / std::sqrt(pivot) : 0.0;
    a[7 * j] = inverse;
    for (std::size_t i = j + 1; i < 6; ++i) {
      double sum = a[6 * i + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[6 * i + k] * a[6 * j + k];
      a[6 * i + j] = sum * inverse;
    }
  }
  return positive;
}

/// One row of several columns that are processed together, and access to such rows.
template <std::size_t width>
struct Row {
  double number[width];
};
template <>
struct Row<4> {
  FourDoubles number;
};

template <std::size_t width>
CALOT_INLINE void read(const double* at, Row<width>& row) {
  if constexpr (width == 4) {
    readVector(at, row.number);
  } else {
    std::copy_n(at, width, row.number);
  }
}

template <std::size_t width>
CALOT_INLINE void write(const Row<width>& row, double* at) {
  if constexpr (width == 4) {
    writeVector(row.number, at);
  } else {
    std::copy_n(row.number, width, at);
  }
}

/// row -= f other.
template <std::size_t width>
CALOT_INLINE void subtractMultiple(Row<width>& row, double f, const Row<width>& other) {
  if constexpr (width == 4) {
    row.number -= f * other.number;
  } else {
    for (std::size_t c = 0; c < width; ++c) row.number[c] -= f * other.number[c];
  }
}

template <std::size_t width>
CALOT_INLINE void scale(Row<width>& row, double f) {
  if constexpr (width == 4) {
    row.number *= f;
  } else {
    for (double& x : row.number) x *= f;
  }
}

template <std::size_t width>
CALOT_INLINE void readAll(const double* at, Row<width>* rows) {
  for (std::size_t i = 0; i < 6; ++i) read(at + width * i, rows[i]);
}

template <std::size_t width>
CALOT_INLINE void writeAll(const Row<width>* rows, double* at) {
  for (std::size_t i = 0; i < 6; ++i) write(rows[i], at + width * i);
}

/// x <- L^-1 x for `width` columns of row-major x.
template <std::size_t width>
CALOT_INLINE void forward(const Block6& l, double* x) {
  Row<width> row[6];
  readAll(x, row);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < i; ++k) subtractMultiple(row[i], l[6 * i + k], row[k]);
    scale(row[i], l[7 * i]);
  }
  writeAll(row, x);
}

/// x <- L^-T x.
template <std::size_t width>
CALOT_INLINE void backward(const Block6& l, double* x) {
  Row<width> row[6];
  readAll(x, row);
  for (std::size_t i = 6; i-- > 0;) {
    for (std::size_t k = i + 1; k < 6; ++k) subtractMultiple(row[i], l[6 * k + i], row[k]);
    scale(row[i], l[7 * i]);
  }
  writeAll(row, x);
}

/// y -= W^T x.
template <std::size_t width>
CALOT_INLINE void subtractTransposed(const Block6& w, const double* x, double* y) {
  Row<width> from[6];
  Row<width> to[6];
  readAll(x, from);
  readAll(y, to);
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < 6; ++i) subtractMultiple(to[i], w[6 * k + i], from[k]);
  }
  writeAll(to, y);
}

/// y -= W x.
template <std::size_t width>
CALOT_INLINE void subtract(const Block6& w, const double* x, double* y) {
  Row<width> from[6];
  Row<width> to[6];
  readAll(x, from);
  readAll(y, to);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) subtractMultiple(to[i], w[6 * i + k], from[k]);
  }
  writeAll(to, y);
}

/// BlockTree::columns(). @param x scratch for each node
CALOT_LANE_KERNEL void columnsOf(const Block6* diagonal, const Block6* coupling, std::span<const int> parent,
                                 std::size_t node, Columns* x, double* out) {
  for (std::size_t i = 0; i < parent.size(); ++i) x[i].fill(0.0);
  for (std::size_t k = 0; k < 3; ++k) x[node][5 * k] = 1.0;
  // Upward, only the path from the node to its root changes.
  for (int at = static_cast<int>(node); at >= 0;) {
    const auto i = static_cast<std::size_t>(at);
    forward<4>(diagonal[i], x[i].data());
    at = parent[i];
    if (at >= 0) subtractTransposed<4>(coupling[i], x[i].data(), x[static_cast<std::size_t>(at)].data());
  }
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] >= 0) subtract<4>(coupling[i], x[static_cast<std::size_t>(parent[i])].data(), x[i].data());
    backward<4>(diagonal[i], x[i].data());
    for (std::size_t k = 0; k < 9; ++k) out[9 * i + k] = x[i][k / 3 * 4 + k % 3];
  }
}

}  // namespace

void BlockTree::reset(std::size_t nodes) {
  diagonal_.assign(nodes, Block6{});
  coupling_.assign(nodes, Block6{});
  work_.resize(nodes);
}

bool BlockTree::factor(std::span<const int> parent) {
  assert(parent.size() == diagonal_.size());
  bool positive = true;
  for (std::size_t i = diagonal_.size(); i-- > 0;) {
    positive = factorBlock(diagonal_[i]) && positive;
    if (parent[i] < 0) continue;
    forward<6>(diagonal_[i], coupling_[i].data());
    subtractTransposed<6>(coupling_[i], coupling_[i].data(), diagonal_[static_cast<std::size_t>(parent[i])].data());
  }
  return positive;
}

void BlockTree::solve(std::span<const int> parent, std::span<Vector6> x) const {
  for (std::size_t i = diagonal_.size(); i-- > 0;) {
    forward<1>(diagonal_[i], x[i].data());
    if (parent[i] >= 0) {
      subtractTransposed<1>(coupling_[i], x[i].data(), x[static_cast<std::size_t>(parent[i])].data());
    }
  }
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    if (parent[i] >= 0) subtract<1>(coupling_[i], x[static_cast<std::size_t>(parent[i])].data(), x[i].data());
    backward<1>(diagonal_[i], x[i].data());
  }
}

void BlockTree::eliminate(std::size_t node, Block6& inverse, Block6& gain) const {
  inverse.fill(0.0);
  for (std::size_t i = 0; i < 6; ++i) inverse[7 * i] = 1.0;
  forward<6>(diagonal_[node], inverse.data());
  backward<6>(diagonal_[node], inverse.data());
  gain = coupling_[node];
  backward<6>(diagonal_[node], gain.data());
}

void BlockTree::columns(std::span<const int> parent, std::size_t node, std::span<double> out) {
  columnsOf(diagonal_.data(), coupling_.data(), parent, node, work_.data(), out.data());
}

void TreeResponse::precompute(const BlockTree& tree, std::span<const int> parent,
                              std::span<const std::uint32_t> touched) {
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
  const EightFloats rotated = (x[4] * column[3] + x[5] * column[4]) + x[6] * column[5];
  sum = moved + rotated;
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

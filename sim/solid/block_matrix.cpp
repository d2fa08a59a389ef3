// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/block_matrix.h"

#include <algorithm>
#include <cassert>

#include "sim/math/vectors.h"
#include "sim/solid/sweeps.h"

namespace calot {

std::vector<std::vector<int>> coloured(const std::vector<std::vector<int>>& neighbours) {
  std::vector<int> colour(neighbours.size(), -1);
  std::vector<std::vector<int>> out;
  std::vector<bool> taken;
  for (std::size_t node = 0; node < neighbours.size(); ++node) {
    taken.assign(out.size() + 1, false);
    for (const int n : neighbours[node]) {
      const int c = colour[static_cast<std::size_t>(n)];
      if (c >= 0) taken[static_cast<std::size_t>(c)] = true;
    }
    const auto c = static_cast<std::size_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
    if (c == out.size()) out.emplace_back();
    out[c].push_back(static_cast<int>(node));
    colour[node] = static_cast<int>(c);
  }
  return out;
}

BlockMatrix::BlockMatrix(const std::vector<std::vector<int>>& columns) : left_(columns.size(), 0) {
  assert(columns.size() % laneCount == 0);
  for (std::size_t s = 0; s < columns.size() / laneCount; ++s) {
    std::size_t width = 0;
    for (std::size_t r = s * laneCount; r < (s + 1) * laneCount; ++r) {
      if (columns[r].empty()) continue;
      assert(columns[r].back() == static_cast<int>(r) && columns[r].size() <= 256);
      left_[r] = static_cast<std::uint8_t>(columns[r].size() - 1);
      width = std::max(width, std::size_t{left_[r]});
    }
    diagonal_.push_back(sliceStart_.back() + width);
    sliceStart_.push_back(diagonal_.back() + 1);
  }
  // Padding refers to the row itself, with value 0.
  column_.resize(sliceStart_.back() * laneCount);
  for (std::size_t s = 0; s < slices(); ++s) {
    for (std::size_t k = sliceStart_[s]; k < sliceStart_[s + 1]; ++k) {
      for (std::size_t l = 0; l < laneCount; ++l) {
        column_[k * laneCount + l] = static_cast<std::int32_t>((s * laneCount + l) * rowStride);
      }
    }
  }
  for (std::size_t r = 0; r < columns.size(); ++r) {
    for (std::size_t k = 0; k < columns[r].size(); ++k) {
      const std::size_t at = slot(r, k) / (9 * laneCount);
      column_[at * laneCount + r % laneCount] =
          static_cast<std::int32_t>(static_cast<std::size_t>(columns[r][k]) * rowStride);
    }
  }
}

std::size_t BlockMatrix::slot(std::size_t row, std::size_t k) const {
  const std::size_t s = row / laneCount;
  assert(k <= left_[row]);
  const std::size_t blockColumn = k < left_[row] ? sliceStart_[s] + k : diagonal_[s];
  return blockColumn * 9 * laneCount + row % laneCount;
}

namespace {

/// Number k everywhere.
template <int k>
CALOT_INLINE void spread(const FourDoubles& v, FourDoubles& out) {
  out = __builtin_shufflevector(v, v, k, k, k, k);
}

/// @param out three rows of four numbers
CALOT_LANE_KERNEL void sumRows(const double* a, std::size_t countA, const double* block, const double* c,
                               std::size_t countC, double* out) {
  FourDoubles sum[3] = {};
  for (std::size_t i = 0; i < countA; ++i) {
    const double* rotation = a + 12 * i;
    for (std::size_t j = 0; j < countC; ++j, block += 9) {
      FourDoubles row[3];
      FourDoubles column[3];
      for (std::size_t k = 0; k < 3; ++k) {
        readVector(block + 3 * k, row[k]);
        readVector(c + 12 * j + 4 * k, column[k]);
      }
      for (std::size_t r = 0; r < 3; ++r) {
        const FourDoubles once = rotation[r] * row[0] + (rotation[4 + r] * row[1] + rotation[8 + r] * row[2]);
        FourDoubles x;
        FourDoubles y;
        FourDoubles z;
        spread<0>(once, x);
        spread<1>(once, y);
        spread<2>(once, z);
        sum[r] += x * column[0] + (y * column[1] + z * column[2]);
      }
    }
  }
  for (std::size_t r = 0; r < 3; ++r) writeVector(sum[r], out + 4 * r);
}

}  // namespace

RotatedColumns columnsOf(const Mat3& matrix) {
  RotatedColumns out{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t r = 0; r < 3; ++r) out[4 * k + r] = matrix(static_cast<int>(r), static_cast<int>(k));
  }
  return out;
}

Mat3 sumOfRotated(std::span<const RotatedColumns> a, std::span<const double> block, std::span<const RotatedColumns> c) {
  assert(block.size() == 9 * a.size() * c.size() + 1);
  double rows[12];
  sumRows(a.data()->data(), a.size(), block.data(), c.data()->data(), c.size(), rows);
  Mat3 out;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out(r, k) = rows[4 * r + k];
  }
  return out;
}

}  // namespace calot

namespace calot::sweeps {

namespace {

using rows::Eight;
using rows::Four;

constexpr std::size_t sliceRows = laneCount * rowStride;  ///< numbers of a slice by rows

/// v = R v, or R^T v: v + w t + q x t, t = 2 q x v.
CALOT_INLINE void rotate(const float* quaternion, bool back, Eight* v) {
  Eight q[4];
  for (std::size_t i = 0; i < 4; ++i) readVector(quaternion + i * laneCount, q[i]);
  if (back) {
    for (std::size_t i = 1; i < 4; ++i) q[i] = -q[i];
  }
  const Eight t[3] = {2.0F * (q[2] * v[2] - q[3] * v[1]), 2.0F * (q[3] * v[0] - q[1] * v[2]),
                      2.0F * (q[1] * v[1] - q[2] * v[0])};
  v[0] += q[0] * t[0] + (q[2] * t[2] - q[3] * t[1]);
  v[1] += q[0] * t[1] + (q[3] * t[0] - q[1] * t[2]);
  v[2] += q[0] * t[2] + (q[1] * t[1] - q[2] * t[0]);
}

}  // namespace

CALOT_LANE_KERNEL void unrotateRows(const float* quaternion, const float* in, float* out, std::size_t slices) {
  for (std::size_t s = 0; s < slices; ++s) {
    Eight v[3];
    readVectors<3>(in + s * laneStride, v);
    rotate(quaternion + s * 4 * laneCount, true, v);
    rows::storeRows(v, out + s * sliceRows);
  }
}

CALOT_LANE_KERNEL void rotateRows(const float* quaternion, const float* in, float* out, std::size_t slices) {
  for (std::size_t s = 0; s < slices; ++s) {
    Eight v[3];
    rows::lanesOf(in + s * sliceRows, v);
    rotate(quaternion + s * 4 * laneCount, false, v);
    writeVectors<3>(v, out + s * laneStride);
  }
}

CALOT_LANE_KERNEL double dot(const float* a, const float* b, std::size_t count) {
  LaneSums sum;
  for (std::size_t k = 0; k < count; k += laneCount) {
    Eight x;
    Eight y;
    readVector(a + k, x);
    readVector(b + k, y);
    sum.addProducts(x, y);
  }
  const FourDoubles &low = sum.low, &high = sum.high;
  return ((low[0] + low[1]) + (low[2] + low[3])) + ((high[0] + high[1]) + (high[2] + high[3]));
}

CALOT_LANE_KERNEL void gather(const Part* part, std::size_t count, const float* rows, float* out) {
  Four sum[4] = {};
  Four own;
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    for (std::size_t i = 0; i < 4; ++i) {
      readVector(rows + part[k + i].row, own);
      sum[i] += part[k + i].weight * own;
    }
  }
  for (; k < count; ++k) {
    readVector(rows + part[k].row, own);
    sum[0] += part[k].weight * own;
  }
  const Four all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  for (std::size_t i = 0; i < 3; ++i) out[i] = all[i];
}

CALOT_LANE_KERNEL void denseTimes(const float* matrix, const float* in, std::size_t size, std::size_t stride,
                                  float* out) {
  for (std::size_t i = 0; i < size; ++i) {
    Eight sum{};
    for (std::size_t j = 0; j < stride; j += laneCount) {
      Eight value;
      Eight own;
      readVector(matrix + i * stride + j, value);
      readVector(in + j, own);
      sum += value * own;
    }
    out[i / 3 * rowStride + i % 3] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
  }
}

CALOT_LANE_KERNEL void spread(const Share* share, std::size_t count, const float* edges, float* out) {
  for (std::size_t row = 0; row < count; ++row) {
    Eight weight;
    readVector(share[row].weight.data(), weight);
    const Eight by[4] = {__builtin_shufflevector(weight, weight, 0, 0, 0, 0, 1, 1, 1, 1),
                         __builtin_shufflevector(weight, weight, 2, 2, 2, 2, 3, 3, 3, 3),
                         __builtin_shufflevector(weight, weight, 4, 4, 4, 4, 5, 5, 5, 5),
                         __builtin_shufflevector(weight, weight, 6, 6, 6, 6, 7, 7, 7, 7)};
    Eight sum{};
    for (std::size_t e = 0; e < 4; ++e) {
      Eight ends;
      readVector(edges + static_cast<std::size_t>(share[row].edge[e]) * 2 * rowStride, ends);
      sum += by[e] * ends;
    }
    const Four all =
        Four(__builtin_shufflevector(sum, sum, 0, 1, 2, 3)) + Four(__builtin_shufflevector(sum, sum, 4, 5, 6, 7));
    writeVector(all, out + row * rowStride);
  }
}

}  // namespace calot::sweeps

// SPDX-License-Identifier: GPL-3.0-or-later

#include "sim/solid/block_matrix.h"

#include <algorithm>
#include <cassert>

#include "sim/math/vectors.h"

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

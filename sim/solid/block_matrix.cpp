// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/block_matrix.h"

#include <algorithm>
#include <cassert>

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

}  // namespace calot

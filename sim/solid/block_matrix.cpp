// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/block_matrix.h"

#include <algorithm>
#include <array>

namespace calot {

namespace {

CALOT_LANE_KERNEL void multiplySlice(const float* values, const std::int32_t* column, std::size_t width, const float* x,
                                     float* y) {
  float y0[laneCount] = {};
  float y1[laneCount] = {};
  float y2[laneCount] = {};
  for (std::size_t k = 0; k < width; ++k) {
    const float* v = values + k * 9 * laneCount;
    const std::int32_t* c = column + k * laneCount;
    for (std::size_t l = 0; l < laneCount; ++l) {
      const float x0 = x[c[l]];
      const float x1 = x[c[l] + laneCount];
      const float x2 = x[c[l] + 2 * laneCount];
      y0[l] += (v[l] * x0 + v[8 + l] * x1) + v[16 + l] * x2;
      y1[l] += (v[24 + l] * x0 + v[32 + l] * x1) + v[40 + l] * x2;
      y2[l] += (v[48 + l] * x0 + v[56 + l] * x1) + v[64 + l] * x2;
    }
  }
  for (std::size_t l = 0; l < laneCount; ++l) {
    y[l] = y0[l];
    y[8 + l] = y1[l];
    y[16 + l] = y2[l];
  }
}

CALOT_LANE_KERNEL void multiplyRowMany(const float* values, const std::int32_t* column, std::size_t width,
                                       const float* x, float* y) {
  float y0[laneCount] = {};
  float y1[laneCount] = {};
  float y2[laneCount] = {};
  for (std::size_t k = 0; k < width; ++k) {
    const float* v = values + k * 9 * laneCount;
    const auto c = static_cast<std::size_t>(column[k * laneCount]);
    // The offset of a row in the layout of one vector gives its row, and so its place in the layout of eight.
    const float* xc = x + (c / laneStride * laneCount + c % laneStride) * laneStride;
    for (std::size_t n = 0; n < laneCount; ++n) {
      y0[n] += (v[0] * xc[n] + v[8] * xc[8 + n]) + v[16] * xc[16 + n];
      y1[n] += (v[24] * xc[n] + v[32] * xc[8 + n]) + v[40] * xc[16 + n];
      y2[n] += (v[48] * xc[n] + v[56] * xc[8 + n]) + v[64] * xc[16 + n];
    }
  }
  for (std::size_t n = 0; n < laneCount; ++n) {
    y[n] = y0[n];
    y[8 + n] = y1[n];
    y[16 + n] = y2[n];
  }
}

}  // namespace

BlockMatrix::BlockMatrix(const std::vector<std::vector<int>>& columns) : rows_(columns.size()) {
  const std::size_t sliceCount = laneGroups(rows_);
  sliceStart_.push_back(0);
  for (std::size_t s = 0; s < sliceCount; ++s) {
    std::size_t width = 1;
    for (std::size_t r = s * laneCount; r < std::min(rows_, (s + 1) * laneCount); ++r) {
      width = std::max(width, columns[r].size());
    }
    sliceStart_.push_back(sliceStart_.back() + static_cast<std::int32_t>(width));
  }
  column_.resize(static_cast<std::size_t>(sliceStart_.back()) * laneCount);
  for (std::size_t r = 0; r < sliceCount * laneCount; ++r) {
    const auto start = static_cast<std::size_t>(sliceStart_[r / laneCount]);
    const std::size_t width = static_cast<std::size_t>(sliceStart_[r / laneCount + 1]) - start;
    for (std::size_t k = 0; k < width; ++k) {
      // Padding refers to the row itself, with value 0.
      const std::size_t c = r < rows_ && k < columns[r].size() ? static_cast<std::size_t>(columns[r][k]) : r;
      column_[(start + k) * laneCount + r % laneCount] = static_cast<std::int32_t>(laneOffset(c));
    }
  }
}

double BlockMatrix::multiply(std::span<const float> values, const float* x, float* y, std::size_t first,
                             std::size_t last) const {
  std::array<double, laneCount> sum{};
  for (std::size_t s = first; s < last; ++s) {
    const auto start = static_cast<std::size_t>(sliceStart_[s]);
    const std::size_t width = static_cast<std::size_t>(sliceStart_[s + 1]) - start;
    multiplySlice(values.data() + start * 9 * laneCount, column_.data() + start * laneCount, width, x,
                  y + s * laneStride);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t l = 0; l < laneCount; ++l) {
        const std::size_t at = s * laneStride + i * laneCount + l;
        sum[l] += static_cast<double>(x[at]) * static_cast<double>(y[at]);
      }
    }
  }
  double total = 0.0;
  for (std::size_t l = 0; l < laneCount; ++l) total += sum[l];
  return total;
}

void BlockMatrix::multiplyMany(std::span<const float> values, const float* x, float* y, std::size_t first,
                               std::size_t last, double* dot) const {
  for (std::size_t r = first * laneCount; r < last * laneCount; ++r) {
    const std::size_t s = r / laneCount;
    const auto start = static_cast<std::size_t>(sliceStart_[s]);
    const std::size_t width = static_cast<std::size_t>(sliceStart_[s + 1]) - start;
    const std::size_t lane = r % laneCount;
    multiplyRowMany(values.data() + start * 9 * laneCount + lane, column_.data() + start * laneCount + lane, width, x,
                    y + r * laneStride);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < laneCount; ++n) {
        const std::size_t at = r * laneStride + i * laneCount + n;
        dot[n] += static_cast<double>(x[at]) * static_cast<double>(y[at]);
      }
    }
  }
}

}  // namespace calot

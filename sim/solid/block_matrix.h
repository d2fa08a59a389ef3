// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric block matrix of 3x3 blocks in slices of eight rows, one row a lane (sliced ELLPACK; Kreutzer et al. 2014,
// "A unified sparse matrix data format", with C = 8 and no sorting).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/lanes.h"

namespace calot {

/// A vector over block rows: component i of row r stands at laneOffset(r) + 8 i. Rows are padded to whole slices.
inline constexpr std::size_t laneStride = 3 * laneCount;
constexpr std::size_t laneOffset(std::size_t row) { return row / laneCount * laneStride + row % laneCount; }

/// A block that the structure has no place for: y_row += value x_column.
struct ExtraBlock {
  std::size_t row = 0;
  std::size_t column = 0;
  std::array<float, 9> value{};  ///< row-major
};

/// Structure and values; the structure is part of Model, the values are rebuilt in every step.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// @param columns per row: the columns of its blocks, ascending, with the diagonal among them.
  explicit BlockMatrix(const std::vector<std::vector<int>>& columns);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t slices() const { return sliceStart_.empty() ? 0 : sliceStart_.size() - 1; }
  [[nodiscard]] std::size_t vectorSize() const { return slices() * laneStride; }

  /// Place of block (row, k-th of its columns): entry (i, j) stands in the values at slot + 8 (3 i + j).
  [[nodiscard]] std::size_t slot(std::size_t row, std::size_t k) const {
    return (static_cast<std::size_t>(sliceStart_[row / laneCount]) + k) * 9 * laneCount + row % laneCount;
  }
  [[nodiscard]] std::size_t valueCount() const { return static_cast<std::size_t>(sliceStart_.back()) * 9 * laneCount; }

  /// y = A x over slices [first, last); returns the part of x . y of these rows, lane sums added in lane order.
  double multiply(std::span<const float> values, const float* x, float* y, std::size_t first, std::size_t last) const;

  /// Y = A X for eight vectors at once: component i of row r of vector k stands at 24 r + 8 i + k. Rows [8 first,
  /// 8 last); adds the parts of x_k . y_k of these rows to dot[k].
  void multiplyMany(std::span<const float> values, const float* x, float* y, std::size_t first, std::size_t last,
                    double* dot) const;

 private:
  std::size_t rows_ = 0;
  std::vector<std::int32_t> sliceStart_;  ///< in block columns
  std::vector<std::int32_t> column_;      ///< laneOffset of the column, per block column and lane
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric block matrix of 3x3 blocks in slices of eight rows, one row a lane (sliced ELLPACK; Kreutzer et al. 2014,
// "A unified sparse matrix data format", with C = 8): the diagonal and what is left of it. Half the numbers are half
// the way through the caches, which is what a sweep waits for. Rows are ordered by colour: rows of one colour do not
// depend on each other, so a Gauss-Seidel sweep takes eight at a time.
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
/// Numbers of a row in a vector by rows: three components and one to fill up.
inline constexpr std::size_t rowStride = 4;

/// A block that the structure has no place for: y_row += value x_column.
struct ExtraBlock {
  std::size_t row = 0;
  std::size_t column = 0;
  std::array<float, 9> value{};  ///< row-major
};

/// Colours of a graph's nodes by first fit: no two neighbours alike.
/// @param neighbours per node; @return per colour its nodes, ascending.
std::vector<std::vector<int>> coloured(const std::vector<std::vector<int>>& neighbours);

/// Structure and values; the structure is part of Model, the values are rebuilt in every step.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// @param columns per row: the columns of its blocks up to the diagonal, ascending, the diagonal last; none where the
  /// row only fills a slice up.
  /// @pre whole slices; no two rows of a slice have a block with each other.
  explicit BlockMatrix(const std::vector<std::vector<int>>& columns);

  /// Of a slice: the blocks left of the diagonal.
  struct Part {
    std::size_t first;  ///< block column in the values
    std::size_t width;  ///< block columns
    [[nodiscard]] std::size_t value() const { return first * 9 * laneCount; }
  };

  [[nodiscard]] std::size_t rows() const { return slices() * laneCount; }
  [[nodiscard]] std::size_t slices() const { return diagonal_.size(); }
  [[nodiscard]] std::size_t vectorSize() const { return slices() * laneStride; }
  /// Place of block (row, k-th of its columns): entry (i, j) stands in the values at slot + 8 (3 i + j).
  /// @pre k is less than the number of the row's columns
  [[nodiscard]] std::size_t slot(std::size_t row, std::size_t k) const;
  [[nodiscard]] std::size_t valueCount() const { return sliceStart_.back() * 9 * laneCount; }

  [[nodiscard]] Part lower(std::size_t slice) const {
    return {sliceStart_[slice], diagonal_[slice] - sliceStart_[slice]};
  }
  /// Where the values of a slice's diagonal blocks begin.
  [[nodiscard]] std::size_t diagonal(std::size_t slice) const { return diagonal_[slice] * 9 * laneCount; }
  /// Per slice the block column that it begins with, and that of its diagonal, with which it ends.
  [[nodiscard]] std::span<const std::size_t> firstColumns() const { return {sliceStart_.data(), slices()}; }
  [[nodiscard]] std::span<const std::size_t> diagonalColumns() const { return diagonal_; }
  /// Where the column of each lane begins in a vector by rows, per block column.
  [[nodiscard]] const std::int32_t* column(std::size_t blockColumn) const {
    return column_.data() + blockColumn * laneCount;
  }

 private:
  std::vector<std::size_t> sliceStart_{0};  ///< in block columns
  std::vector<std::size_t> diagonal_;       ///< per slice: its block column
  std::vector<std::uint8_t> left_;          ///< per row: how many of its blocks stand left of the diagonal
  std::vector<std::int32_t> column_;
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric block matrix of 3x3 blocks in slices of eight rows, one row per lane (sliced ELLPACK; Kreutzer et al. 2014,
// "A unified sparse matrix data format", with C = 8). Only the lower triangle is stored, which halves the memory
// traffic that bounds a sweep. Rows are ordered by colour: rows of one colour are independent, so a Gauss-Seidel sweep
// processes eight at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

/// A vector over block rows stores component i of row r at laneOffset(r) + 8 i. Rows are padded to whole slices.
inline constexpr std::size_t laneStride = 3 * laneCount;
constexpr std::size_t laneOffset(std::size_t row) { return row / laneCount * laneStride + row % laneCount; }
/// Numbers per row in a vector stored by rows: three components and one of padding.
inline constexpr std::size_t rowStride = 4;

/// A block outside the sparsity structure: y_row += value x_column.
struct ExtraBlock {
  std::size_t row = 0;
  std::size_t column = 0;
  std::array<float, 9> value{};  ///< row-major
};

/// First-fit colouring of a graph: neighbours get different colours.
/// @param neighbours per node; @return per colour its nodes, ascending.
std::vector<std::vector<int>> coloured(const std::vector<std::vector<int>>& neighbours);

/// Structure and values; the structure is part of Model, the values are rebuilt in every step.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// @param columns per row: columns of its blocks up to the diagonal, ascending, the diagonal last;
  /// empty for padding rows.
  /// @pre whole slices; no two rows of a slice have a block with each other.
  explicit BlockMatrix(const std::vector<std::vector<int>>& columns);

  /// Blocks of a slice left of the diagonal.
  struct Part {
    std::size_t first;  ///< block column in the values
    std::size_t width;  ///< block columns
    [[nodiscard]] std::size_t value() const { return first * 9 * laneCount; }
  };

  [[nodiscard]] std::size_t rows() const { return slices() * laneCount; }
  [[nodiscard]] std::size_t slices() const { return diagonal_.size(); }
  [[nodiscard]] std::size_t vectorSize() const { return slices() * laneStride; }
  /// Offset of a row's k-th block in the values; its entry (i, j) is at slot + 8 (3 i + j).
  /// @pre k is less than the number of the row's columns
  [[nodiscard]] std::size_t slot(std::size_t row, std::size_t k) const;
  [[nodiscard]] std::size_t valueCount() const { return sliceStart_.back() * 9 * laneCount; }

  [[nodiscard]] Part lower(std::size_t slice) const {
    return {sliceStart_[slice], diagonal_[slice] - sliceStart_[slice]};
  }
  /// Offset of a slice's diagonal blocks in the values.
  [[nodiscard]] std::size_t diagonal(std::size_t slice) const { return diagonal_[slice] * 9 * laneCount; }
  /// Per slice: its first block column, and that of its diagonal, which is its last.
  [[nodiscard]] std::span<const std::size_t> firstColumns() const { return {sliceStart_.data(), slices()}; }
  [[nodiscard]] std::span<const std::size_t> diagonalColumns() const { return diagonal_; }
  /// Per block column: offsets of the eight lanes' columns in a vector stored by rows.
  [[nodiscard]] const std::int32_t* column(std::size_t blockColumn) const {
    return column_.data() + blockColumn * laneCount;
  }

 private:
  std::vector<std::size_t> sliceStart_{0};  ///< in block columns
  std::vector<std::size_t> diagonal_;       ///< per slice: its block column
  std::vector<std::uint8_t> left_;          ///< per row: number of blocks left of the diagonal
  std::vector<std::int32_t> column_;
};

// Sums of 3x3 blocks between nodes, each rotated with its nodes: compliance between two points of a body.

/// A matrix by columns, each padded to four numbers.
using RotatedColumns = std::array<double, 12>;
RotatedColumns columnsOf(const Mat3& matrix);

/// sum over i, then j of  A_i B_ij C_j^T, in this order, with the bits of the plain expression of Eigen.
/// @param block B_ij, row-major, at 9 (i nb + j) for nb matrices C; and one number of padding
/// @pre block.size() = 9 na nb + 1
Mat3 sumOfRotated(std::span<const RotatedColumns> a, std::span<const double> block, std::span<const RotatedColumns> c);

}  // namespace calot

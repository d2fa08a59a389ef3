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

// Vectors by rows (rowStride numbers each), to and from lanes (one row a lane). Internal to this folder.

namespace calot::rows {

using Four = FourFloats;
using Eight = EightFloats;

/// Concatenates two rows of four numbers.
CALOT_INLINE void join(const Four& low, const Four& high, Eight& out) {
  out = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Transposes eight rows, the l-th at x + row[l], to three components of eight lanes.
CALOT_INLINE void toLanes(const float* x, const std::int32_t* row, Eight* out) {
  Four first[4];  // of rows 2 l and 2 l + 1: x x y y
  Four last[4];   // and z z and padding
  for (std::size_t l = 0; l < 4; ++l) {
    Four a;
    Four b;
    readVector(x + row[2 * l], a);
    readVector(x + row[2 * l + 1], b);
    first[l] = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    last[l] = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  }
  Eight even;
  Eight odd;
  join(first[0], first[2], even);
  join(first[1], first[3], odd);
  out[0] = __builtin_shufflevector(even, odd, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(even, odd, 2, 3, 10, 11, 6, 7, 14, 15);
  join(last[0], last[2], even);
  join(last[1], last[3], odd);
  out[2] = __builtin_shufflevector(even, odd, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// Transposes three components of eight lanes, and padding, to eight rows: row l in half l / 4 of out[l % 4].
CALOT_INLINE void toRows(const Eight* lanes, const Eight& last, Eight* out) {
  const Eight low = __builtin_shufflevector(lanes[0], lanes[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight high = __builtin_shufflevector(lanes[0], lanes[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight lowLast = __builtin_shufflevector(lanes[2], last, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight highLast = __builtin_shufflevector(lanes[2], last, 2, 10, 3, 11, 6, 14, 7, 15);
  out[0] = __builtin_shufflevector(low, lowLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(low, lowLast, 2, 3, 10, 11, 6, 7, 14, 15);
  out[2] = __builtin_shufflevector(high, highLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[3] = __builtin_shufflevector(high, highLast, 2, 3, 10, 11, 6, 7, 14, 15);
}

CALOT_INLINE void toRows(const Eight* lanes, Eight* out) { toRows(lanes, Eight{}, out); }

/// Adds four numbers.
CALOT_INLINE void addTo(float* at, const Four& what) {
  Four own;
  readVector(at, own);
  own += what;
  writeVector(own, at);
}

/// Adds three components of eight lanes to rows, the l-th at x + row[l], in order of the lanes.
CALOT_INLINE void addRows(const Eight* lanes, const std::int32_t* row, float* x) {
  Eight rows[4];
  toRows(lanes, rows);
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[4 + l], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
}

/// Numbers of a pair of rows, one from each of two vectors.
inline constexpr std::size_t pairStride = 2 * rowStride;

/// Interleaves numbers of a and b: the first two of each half, and (high) the last two.
CALOT_INLINE void interleave(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}
/// Interleaves pairs of numbers of a and b: the first of each half, and (high) the second.
CALOT_INLINE void interleavePairs(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  high = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
/// The first halves of a and b, and (high) the second.
CALOT_INLINE void halves(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
  high = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

/// Transposes eight pairs of rows, the l-th at x + 2 row[l], to three components of eight lanes of each vector.
CALOT_INLINE void pairsToLanes(const float* x, const std::int32_t* row, Eight* first, Eight* second) {
  Eight part[2][3];  // component i of rows 4 h to 4 h + 3, of each vector in a half
  for (std::size_t h = 0; h < 2; ++h) {
    Eight own[4];
    for (std::size_t l = 0; l < 4; ++l) readVector(x + 2 * row[4 * h + l], own[l]);
    Eight cross[4];
    interleave(own[0], own[1], cross[0], cross[1]);
    interleave(own[2], own[3], cross[2], cross[3]);
    Eight fill;
    interleavePairs(cross[0], cross[2], part[h][0], part[h][1]);
    interleavePairs(cross[1], cross[3], part[h][2], fill);
  }
  for (std::size_t i = 0; i < 3; ++i) halves(part[0][i], part[1][i], first[i], second[i]);
}

/// Adds three components of eight lanes of each of two vectors to pairs of rows, in order of the lanes.
CALOT_INLINE void addPairs(const Eight* first, const Eight* second, const std::int32_t* row, float* x) {
  Eight part[2][3];
  for (std::size_t i = 0; i < 3; ++i) halves(first[i], second[i], part[0][i], part[1][i]);
  const Eight none{};
  for (std::size_t h = 0; h < 2; ++h) {
    Eight cross[4];
    interleave(part[h][0], part[h][1], cross[0], cross[1]);
    interleave(part[h][2], none, cross[2], cross[3]);
    Eight out[4];
    interleavePairs(cross[0], cross[2], out[0], out[1]);
    interleavePairs(cross[1], cross[3], out[2], out[3]);
    for (std::size_t l = 0; l < 4; ++l) {
      float* at = x + 2 * row[4 * h + l];
      Eight own;
      readVector(at, own);
      own += out[l];
      writeVector(own, at);
    }
  }
}

/// Offsets of consecutive rows.
inline constexpr std::int32_t inOrder[laneCount] = {0, 4, 8, 12, 16, 20, 24, 28};
static_assert(rowStride == 4 && laneCount == 8);

/// Stores a slice's rows in a vector stored by rows.
CALOT_INLINE void storeRows(const Eight* lanes, float* rows) {
  Eight out[4];
  toRows(lanes, out);
  for (std::size_t l = 0; l < 4; ++l) {
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 0, 1, 2, 3)), rows + inOrder[l]);
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 4, 5, 6, 7)), rows + inOrder[4 + l]);
  }
}

/// Stores a slice's rows as the first or the second of pairs.
CALOT_INLINE void storeFirst(const Eight* lanes, float* pairs) {
  Eight out[4];
  toRows(lanes, out);
  for (std::size_t l = 0; l < 4; ++l) {
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 0, 1, 2, 3)), pairs + l * pairStride);
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 4, 5, 6, 7)), pairs + (4 + l) * pairStride);
  }
}
CALOT_INLINE void storeSecond(const Eight* lanes, float* pairs) { storeFirst(lanes, pairs + rowStride); }

/// The rows of a slice as lanes. @param rows the first of them
CALOT_INLINE void lanesOf(const float* rows, Eight* out) { toLanes(rows, inOrder, out); }

}  // namespace calot::rows

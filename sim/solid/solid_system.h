// SPDX-License-Identifier: GPL-3.0-or-later
// Structure of a solid's linear system: the row of each node, the blocks of the matrix, and the element contributions
// to each. It covers all elements, or only the remaining ones: what has been carved away costs nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/hexahedral_elements.h"

namespace calot {

/// Elements of one kind.
struct ElementCorners {
  std::span<const Index4> tetrahedra;
  std::span<const Index8> cubes;  ///< exactly one of the two is used

  [[nodiscard]] bool areCubes() const { return !cubes.empty(); }
  [[nodiscard]] std::size_t count() const { return areCubes() ? cubes.size() : tetrahedra.size(); }
  [[nodiscard]] std::span<const int> of(std::size_t element) const {
    return areCubes() ? std::span<const int>(cubes[element]) : std::span<const int>(tetrahedra[element].data(), 4);
  }
};

class SolidSystem {
 public:
  static constexpr std::uint32_t noSlot = ~std::uint32_t{0};

  /// A block K_ab of one element that contributes to a slot of the matrix, or a force that contributes to a node.
  struct Contribution {
    std::int32_t element;
    std::uint8_t a;  ///< corners of the element
    std::uint8_t b;
  };
  /// A block of the matrix.
  struct Slot {
    std::size_t offset;          ///< in the matrix values
    std::int32_t node;           ///< of a diagonal block; else -1
    std::size_t first, last;     ///< in source_
    std::size_t transposedFrom;  ///< for cubes: contributions from here on are transposed
  };

  SolidSystem() = default;
  /// System of all elements. @param fixed per node: it has no row
  SolidSystem(const ElementCorners& elements, const std::vector<bool>& fixed);
  /// System of the remaining cubes, in the order of the whole; nodes without such a cube have no row.
  /// @param whole of cubes @param present per cube
  SolidSystem(const SolidSystem& whole, std::span<const std::uint8_t> present);

  [[nodiscard]] const BlockMatrix& matrix() const { return matrix_; }
  /// Row of a node, or -1. Padding rows have no node.
  [[nodiscard]] int row(std::size_t node) const { return row_[node]; }
  /// Offset of a node with a row in vectors over the rows.
  [[nodiscard]] std::size_t offsetOf(std::size_t node) const {
    return laneOffset(static_cast<std::size_t>(row_[node]));
  }
  /// Nodes with a row, ascending.
  [[nodiscard]] const std::vector<int>& nodes() const { return node_; }
  /// Offset of block (row, column) in the matrix values, or noSlot. @pre column <= row
  [[nodiscard]] std::uint32_t blockOffset(int row, int column) const;
  /// Blocks of a row by columns, the diagonal last; empty for padding.
  [[nodiscard]] std::span<const Slot> ofRow(std::size_t row) const {
    return {slot_.data() + rowSlot_[row], rowSlot_[row + 1] - rowSlot_[row]};
  }
  /// A block column of a slice: block l is the sum of the contributions sources()[first + 8 c + l], c < count.
  struct Column {
    std::size_t offset;  ///< in the matrix values
    std::size_t first, count;
  };
  /// Block columns of the whole matrix including diagonals, ordered so that blocks of consecutive elements are close.
  [[nodiscard]] const std::vector<Column>& columns() const { return column_; }
  /// For tetrahedra 16 element + 4 a + b, for K_ab. Of cubes 2 (36 element + HexahedralElements::pairOf()), and
  /// 1 more where it is transposed. Lanes with fewer contributions are padded with noElement(): equal trip
  /// counts avoid branch mispredictions.
  [[nodiscard]] const std::vector<std::uint32_t>& sources() const { return columnSource_; }
  /// Index of the zero element, one past those of all lanes. @param elements number of elements
  [[nodiscard]] static std::size_t noElement(std::size_t elements) { return laneCount * laneGroups(elements); }
  /// Offsets of the blocks of an element's corners, row by row; noSlot if there is none or it is right of the diagonal.
  [[nodiscard]] const std::uint32_t* blockOffsets(std::size_t element) const {
    return elementOffset_.data() + element * corners_ * corners_;
  }
  /// Corners of elements at a node.
  [[nodiscard]] std::span<const Contribution> incident(std::size_t node) const {
    return {incident_.data() + incidentStart_[node], incidentStart_[node + 1] - incidentStart_[node]};
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void buildMatrix(const std::vector<std::vector<int>>& columns);
  void locateElements();
  [[nodiscard]] std::vector<std::size_t> slicesByNodes() const;
  void sumColumns();

  std::size_t corners_ = 0;  ///< of an element
  std::vector<int> row_;     ///< per node
  std::vector<int> node_;
  std::vector<std::int32_t> nodeOf_;      ///< per row; -1: padding
  std::vector<std::size_t> colourStart_;  ///< rows
  BlockMatrix matrix_;
  std::vector<Slot> slot_;
  std::vector<std::size_t> rowSlot_;   ///< per row: its first slot; then the end
  std::vector<int> slotColumn_;        ///< per slot
  std::vector<std::uint32_t> source_;  ///< of the slots of cubes: half of sources()
  std::vector<Column> column_;
  std::vector<std::uint32_t> columnSource_;
  std::vector<std::uint32_t> elementSlot_;  ///< slot indices, laid out as elementOffset_
  std::vector<std::uint32_t> elementOffset_;
  std::vector<std::size_t> incidentStart_;
  std::vector<Contribution> incident_;
};

}  // namespace calot

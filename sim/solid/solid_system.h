// SPDX-License-Identifier: GPL-3.0-or-later
// The shape of a solid's linear system: which node has which row, where blocks stand in the matrix, and what of which
// element is added into them. Of all elements, or of those that are still there: what has been carved away costs
// nothing any more.
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
  std::span<const Index8> cubes;  ///< either these or those

  [[nodiscard]] bool areCubes() const { return !cubes.empty(); }
  [[nodiscard]] std::size_t count() const { return areCubes() ? cubes.size() : tetrahedra.size(); }
  [[nodiscard]] std::span<const int> of(std::size_t element) const {
    return areCubes() ? std::span<const int>(cubes[element]) : std::span<const int>(tetrahedra[element].data(), 4);
  }
};

class SolidSystem {
 public:
  static constexpr std::uint32_t noSlot = ~std::uint32_t{0};

  /// A block K_ab of one element that is added into a slot of the matrix, or a force that is added to a node.
  struct Contribution {
    std::int32_t element;
    std::uint8_t a;  ///< corners of the element
    std::uint8_t b;
  };
  /// A block of the matrix.
  struct Slot {
    std::size_t place;        ///< in the matrix values
    std::int32_t node;        ///< of a diagonal block; else -1
    std::size_t first, last;  ///< in source_
    std::size_t turned;       ///< of cubes: those from here on are transposed
  };

  SolidSystem() = default;
  /// Of all elements. @param fixed per node: has no row
  SolidSystem(const ElementCorners& elements, const std::vector<bool>& fixed);
  /// Of the cubes that are there, in the order that the whole has: nodes that no such cube holds have no row.
  /// @param whole of cubes @param present per cube
  SolidSystem(const SolidSystem& whole, std::span<const std::uint8_t> present);

  [[nodiscard]] const BlockMatrix& matrix() const { return matrix_; }
  /// Row of a node, or -1. Some rows have no node: they only fill slices up.
  [[nodiscard]] int row(std::size_t node) const { return row_[node]; }
  /// Where the values of a node that has a row begin in vectors over the rows.
  [[nodiscard]] std::size_t offsetOf(std::size_t node) const {
    return laneOffset(static_cast<std::size_t>(row_[node]));
  }
  /// Nodes with a row, ascending.
  [[nodiscard]] const std::vector<int>& nodes() const { return node_; }
  /// Where block (row, column) stands in the matrix values, or noSlot. @pre column <= row
  [[nodiscard]] std::uint32_t placeOf(int row, int column) const;
  /// Blocks of a row by columns, the diagonal last; none where it only fills a slice up.
  [[nodiscard]] std::span<const Slot> ofRow(std::size_t row) const {
    return {slot_.data() + rowSlot_[row], rowSlot_[row + 1] - rowSlot_[row]};
  }
  /// A block column of a slice: block l is the sum of what sources()[first + 8 c + l], c < count, say.
  struct Column {
    std::size_t place;  ///< in the matrix values
    std::size_t first, count;
  };
  /// Of the whole matrix, the diagonals too; such that of elements that follow one another the blocks do, nearly.
  [[nodiscard]] const std::vector<Column>& columns() const { return column_; }
  /// Of tetrahedra 16 element + 4 a + b, for K_ab. Of cubes 2 (36 element + HexahedralElements::pairOf()), and 1 more
  /// where it is transposed. Of noElement() where a lane has fewer than another: lanes that all sum as many leave
  /// nothing to guess to the processor.
  [[nodiscard]] const std::vector<std::uint32_t>& sources() const { return columnSource_; }
  /// The first behind those of all lanes. @param elements how many there are
  [[nodiscard]] static std::size_t noElement(std::size_t elements) { return laneCount * laneGroups(elements); }
  /// Where the blocks of an element's corners stand, row by row; noSlot where there is none or right of the diagonal.
  [[nodiscard]] const std::uint32_t* placesOf(std::size_t element) const {
    return elementPlace_.data() + element * corners_ * corners_;
  }
  /// Corners of elements at a node.
  [[nodiscard]] std::span<const Contribution> incident(std::size_t node) const {
    return {incident_.data() + incidentStart_[node], incidentStart_[node + 1] - incidentStart_[node]};
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void buildMatrix(const std::vector<std::vector<int>>& columns);
  void placeElements();
  [[nodiscard]] std::vector<std::size_t> slicesByNodes() const;
  void sumColumns();

  std::size_t corners_ = 0;  ///< of an element
  std::vector<int> row_;     ///< per node
  std::vector<int> node_;
  std::vector<std::int32_t> nodeOf_;      ///< per row; -1: fills a slice up
  std::vector<std::size_t> colourStart_;  ///< rows
  BlockMatrix matrix_;
  std::vector<Slot> slot_;
  std::vector<std::size_t> rowSlot_;   ///< per row: its first slot; and the end
  std::vector<int> slotColumn_;        ///< per slot
  std::vector<std::uint32_t> source_;  ///< of the slots of cubes: half of sources()
  std::vector<Column> column_;
  std::vector<std::uint32_t> columnSource_;
  std::vector<std::uint32_t> elementSlot_;  ///< numbers of slots, as elementPlace_; none
  std::vector<std::uint32_t> elementPlace_;
  std::vector<std::size_t> incidentStart_;
  std::vector<Contribution> incident_;
};

}  // namespace calot

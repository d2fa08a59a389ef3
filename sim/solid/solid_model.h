// SPDX-License-Identifier: GPL-3.0-or-later
// A deformable solid: constant data (SolidModel) and State (SolidState).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/elements.h"

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

/// Structure of a solid's linear system: the row of each node, the blocks of the matrix, and the element contributions
/// to each. It covers all elements, or only the remaining ones: what has been carved away costs nothing.
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

/// Constant data of one solid, made of tetrahedra or of cubes.
class SolidModel {
 public:
  struct Material {
    LameConstants lame;
    double density = 0.0;           ///< kg/m^3
    double massDamping = 0.0;       ///< Rayleigh alpha (1/s)
    double stiffnessDamping = 0.0;  ///< Rayleigh beta (s)
  };

  /// @param fixed per node: constrained to its reference position.
  /// @pre positive volumes; every node belongs to a tetrahedron.
  SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, const std::vector<bool>& fixed, Material material);

  /// A solid of equal cubes.
  /// @param edge of the cubes (m)
  /// @pre at rest every cube's nodes lie as Index8 says; every node belongs to a cube.
  SolidModel(std::vector<Vec3> rest, std::vector<Index8> cubes, double edge, const std::vector<bool>& fixed,
             Material material);

  [[nodiscard]] std::size_t nodes() const { return rest_.size(); }
  [[nodiscard]] const std::vector<Vec3>& rest() const { return rest_; }
  [[nodiscard]] const std::vector<Index4>& tetrahedra() const { return tetrahedra_; }
  [[nodiscard]] const Material& material() const { return material_; }
  [[nodiscard]] const std::vector<Index8>& cubes() const { return cube_; }
  /// @pre made of tetrahedra
  [[nodiscard]] const TetrahedralElements& elements() const { return std::get<TetrahedralElements>(elements_); }
  /// @pre made of cubes
  [[nodiscard]] const HexahedralElements& hexahedra() const { return std::get<HexahedralElements>(elements_); }
  [[nodiscard]] bool madeOfCubes() const { return std::holds_alternative<HexahedralElements>(elements_); }
  /// Number of lane groups of its elements; `State` stores one rotation per group.
  [[nodiscard]] std::size_t groups() const;
  /// Lumped masses (kg): an equal share of each incident element, all full.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  /// Their sum.
  [[nodiscard]] double wholeMass() const { return wholeMass_; }
  /// Deformed volume (m^3). @param fill remaining share of each cube; empty span: all full
  [[nodiscard]] double volume(std::span<const Vec3> position, std::span<const double> fill = {}) const;
  /// Row of a node in the system, or -1 if it is fixed. Padding rows have no node.
  [[nodiscard]] int row(std::size_t node) const { return system_.row(node); }
  [[nodiscard]] const std::vector<int>& freeNodes() const { return system_.nodes(); }
  /// The system of all elements.
  [[nodiscard]] const SolidSystem& system() const { return system_; }
  [[nodiscard]] std::size_t elementCount() const { return madeOfCubes() ? cube_.size() : tetrahedra_.size(); }
  /// Nodal masses of partly filled cubes (kg). @pre made of cubes
  void massOf(std::span<const double> fill, std::vector<double>& mass) const;
  /// Loads its elements at rest as these displacements of the nodes (m) would, without moving them: to first order, the
  /// shape that is free of stress is the reference configuration less the displacements. The loads turn with the
  /// elements.
  void preload(std::span<const Vec3> displacement);
  /// Elements at a node, ascending.
  [[nodiscard]] std::vector<std::int32_t> elementsAt(std::size_t node) const;

 private:
  std::vector<Vec3> rest_;
  std::vector<Index4> tetrahedra_;
  std::vector<Index8> cube_;
  Material material_;
  std::variant<TetrahedralElements, HexahedralElements> elements_;
  std::vector<double> mass_;
  double wholeMass_ = 0.0;
  SolidSystem system_;
};

/// State of one solid.
struct SolidState {
  std::vector<Vec3> position;           ///< in W (m)
  std::vector<Vec3> velocity;           ///< (m/s)
  std::vector<RotationGroup> rotation;  ///< co-rotation of each element; the next step starts from it
  std::uint32_t quietSteps = 0;         ///< consecutive steps without contact and below the sleeping speed
  double volume = 0.0;                  ///< deformed (m^3); stored because a sleeping organ does not recompute it
  double maxDisplacement = 0.0;         ///< (m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("velocity", self.velocity);
    visit("rotation", self.rotation);
    visit("quietSteps", self.quietSteps);
    visit("volume", self.volume);
    visit("largestDisplacement", self.maxDisplacement);
  }
};

/// Rotation of one element. @param rotation of all (SolidState::rotation)
Mat3 rotationOf(std::span<const RotationGroup> rotation, int element);

/// Reference state: no displacement, no velocity, asleep.
SolidState restState(const SolidModel& model);

// The matrix of a step without attachments: (1 + alpha h) M + (h^2 + beta h) K, with the elements' rotations of this
// step in K. Reusing K for several steps or small rotations would be cheaper. But where stiffness differs a
// thousandfold, as between a full cube and a nearly empty neighbour, a rotation error of 2 degrees is enough to make
// an implicit step unstable.

class StiffnessAssembly {
 public:
  struct Scale {
    double mass = 1.0;       ///< 1 + alpha h
    double stiffness = 0.0;  ///< h^2 + beta h (s^2)
  };

  /// Writes the values of the matrix (BlockMatrix).
  /// @param system of the model, or of its remaining part
  /// @param fill per cube, or empty  @param mass of the nodes (kg)
  void assemble(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                std::span<const double> fill, std::span<const double> mass, const Scale& scale, Executor& executor,
                std::vector<float>& values);

 private:
  void assembleTetrahedra(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                          float scale, Executor& executor, std::vector<float>& values);
  void assembleCubes(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                     std::span<const double> fill, float scale, Executor& executor, std::vector<float>& values);

  std::vector<float> tetrahedron_;      ///< rotated gradients and volume of each
  std::vector<HexahedronBlocks> cube_;  ///< of cubes, unused lanes too
};

}  // namespace calot

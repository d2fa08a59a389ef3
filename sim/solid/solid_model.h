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
#include "sim/solid/hexahedral_elements.h"
#include "sim/solid/solid_system.h"
#include "sim/solid/tetrahedral_elements.h"

namespace calot {

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

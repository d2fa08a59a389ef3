// SPDX-License-Identifier: GPL-3.0-or-later
// A deformable solid: what is fixed (SolidModel), what changes (SolidState), and implicit Euler over one step.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/tetrahedral_elements.h"

namespace calot {

/// Fixed data of one solid.
class SolidModel {
 public:
  struct Material {
    LameConstants lame;
    double density = 0.0;           ///< kg/m^3
    double massDamping = 0.0;       ///< Rayleigh alpha (1/s)
    double stiffnessDamping = 0.0;  ///< Rayleigh beta (s)
  };

  /// @param fixed per node: held at its rest position.
  /// @pre positive volumes; every node belongs to a tetrahedron.
  SolidModel(std::vector<Vec3> rest, std::vector<Index4> tetrahedra, std::vector<bool> fixed, Material material);

  [[nodiscard]] std::size_t nodes() const { return rest_.size(); }
  [[nodiscard]] const std::vector<Vec3>& rest() const { return rest_; }
  [[nodiscard]] const std::vector<Index4>& tetrahedra() const { return tetrahedra_; }
  [[nodiscard]] const Material& material() const { return material_; }
  [[nodiscard]] const TetrahedralElements& elements() const { return elements_; }
  /// Lumped masses (kg): a quarter of each incident tetrahedron.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  /// Row of a node in the system, or -1 where it is fixed.
  [[nodiscard]] int row(std::size_t node) const { return row_[node]; }
  [[nodiscard]] const std::vector<int>& freeNodes() const { return freeNode_; }
  [[nodiscard]] const BlockMatrix& matrix() const { return matrix_; }
  /// Elements at a node, ascending.
  [[nodiscard]] std::vector<std::int32_t> elementsAt(std::size_t node) const;

 private:
  friend class SolidSolver;
  /// A block K_ab of one element that is added into a slot of the matrix, or a force that is added to a node.
  struct Contribution {
    std::int32_t element;
    std::uint8_t a;  ///< corners of the element
    std::uint8_t b;
  };
  struct SlotRange {
    std::size_t slot;  ///< in the matrix values
    std::int32_t row;
    bool diagonal;
    std::size_t first, last;  ///< in contributions
  };

  void buildStructure();

  std::vector<Vec3> rest_;
  std::vector<Index4> tetrahedra_;
  std::vector<bool> fixed_;
  Material material_;
  TetrahedralElements elements_;
  std::vector<double> mass_;
  std::vector<int> row_;
  std::vector<int> freeNode_;  ///< row -> node
  BlockMatrix matrix_;
  std::vector<int> diagonal_;    ///< per row: which of its columns is the diagonal
  std::vector<SlotRange> slot_;  ///< in row order
  std::vector<Contribution> contribution_;
  std::vector<std::size_t> incidentStart_;  ///< per node
  std::vector<Contribution> incident_;      ///< element and corner of each incident tetrahedron
};

/// Everything of one solid that changes.
struct SolidState {
  std::vector<Vec3> position;           ///< in W (m)
  std::vector<Vec3> velocity;           ///< (m/s)
  std::vector<RotationGroup> rotation;  ///< co-rotation of each tetrahedron, warm start of the next step's
  std::uint32_t quietSteps = 0;         ///< steps in a row without touch and slower than the sleeping speed
  double volume = 0.0;                  ///< deformed (m^3); kept because a sleeping organ does not recompute it
  double largestDisplacement = 0.0;     ///< (m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("position", self.position);
    visit("velocity", self.velocity);
    visit("rotation", self.rotation);
    visit("quietSteps", self.quietSteps);
    visit("volume", self.volume);
    visit("largestDisplacement", self.largestDisplacement);
  }
};

/// Rest: no displacement, no velocity, asleep.
SolidState restState(const SolidModel& model);

/// Implicit Euler, one linearisation a step (Baraff and Witkin 1998): with h = dt,
///   [(1 + alpha h) M + (h^2 + beta h) K] dv = h (f_external + f(x + (h + beta) v) - alpha M v),  v += dv,  x += h v,
/// where K and f are co-rotational with the rotations of x. Holds the matrix of the step for contact.
class SolidSolver {
 public:
  struct Settings {
    double step = 0.01;  ///< h (s)
    double tolerance = 1e-4;
    std::uint32_t cap = 200;
    int rotationSweeps = 2;
  };

  /// Assembles at the state's position and computes the free velocity (without contact) into freeVelocity().
  /// @param external forces on the nodes besides gravity (N), or empty.
  SolveReport freeMotion(const SolidModel& model, SolidState& state, const Vec3& gravity,
                         std::span<const Vec3> external, const Settings& settings, Executor& executor);

  /// Velocities that the step ends with, as far as they are known: free motion and what push() added since.
  [[nodiscard]] const std::vector<Vec3>& freeVelocity() const { return freeVelocity_; }

  /// Adds the answer to impulses on the nodes to freeVelocity(): dv = A^-1 impulse. @pre freeMotion() of this step was
  /// called. @param impulse per node (N s)
  SolveReport push(const SolidModel& model, std::span<const Vec3> impulse, const Settings& settings,
                   Executor& executor);

  /// Velocity responses to up to eight unit impulses, each spread over nodes: column k answers impulse[k].
  /// @pre freeMotion() of this step was called.
  struct Impulse {
    std::array<int, 12> node{};
    std::array<double, 12> weight{};  ///< share of each node
    std::size_t count = 0;            ///< how many of them count
    Vec3 impulse = Vec3::Zero();      ///< N s
  };
  SolveReport responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                        std::vector<std::vector<Vec3>>& response, Executor& executor);

  /// v = freeVelocity() + correction (or nothing), x += h v. Values that are not finite stop the node instead of
  /// entering State.
  /// @return false when that happened.
  bool advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step);

 private:
  void assemble(const SolidModel& model, const Settings& settings, Executor& executor);

  std::vector<ElementResult> element_;
  std::vector<float> values_;
  std::vector<float> b_, x_;
  std::vector<Vec3> freeVelocity_;
  ConjugateGradient cg_;
};

}  // namespace calot

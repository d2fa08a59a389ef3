// SPDX-License-Identifier: GPL-3.0-or-later
// A deformable solid: what is fixed (SolidModel), what changes (SolidState), and implicit Euler over one step.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/hexahedral_elements.h"
#include "sim/solid/tetrahedral_elements.h"

namespace calot {

/// Fixed data of one solid: of tetrahedra, or of cubes.
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

  /// A solid of equal cubes.
  /// @param edge of the cubes (m)
  /// @pre at rest every cube's nodes lie as Index8 says; every node belongs to a cube.
  SolidModel(std::vector<Vec3> rest, std::vector<Index8> cubes, double edge, std::vector<bool> fixed,
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
  /// Groups of lanes that hold its elements: so many rotations has its State.
  [[nodiscard]] std::size_t groups() const;
  /// Lumped masses (kg): an equal share of each incident element, where all are full.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  /// Deformed volume (m^3). @param fill share of each cube that is there; empty: all of it
  [[nodiscard]] double volume(std::span<const Vec3> position, std::span<const double> fill = {}) const;
  /// Row of a node in the system, or -1 where it is fixed. Some rows have no node: they only fill slices up.
  [[nodiscard]] int row(std::size_t node) const { return row_[node]; }
  [[nodiscard]] const std::vector<int>& freeNodes() const { return freeNode_; }
  [[nodiscard]] const BlockMatrix& matrix() const { return matrix_; }
  /// Elements at a node, ascending.
  [[nodiscard]] std::vector<std::int32_t> elementsAt(std::size_t node) const;

 private:
  friend class SolidSolver;
  /// Where the values of a node that moves begin in vectors over the rows.
  [[nodiscard]] std::size_t offsetOf(std::size_t node) const {
    return laneOffset(static_cast<std::size_t>(row_[node]));
  }
  static constexpr std::size_t noSlot = ~std::size_t{0};
  /// Slot of block (row, column), or noSlot where no element has both as corners. @pre column <= row
  [[nodiscard]] std::size_t slotOf(int row, int column) const;
  /// Nodal masses of partly filled cubes (kg).
  void massOf(std::span<const double> fill, std::vector<double>& mass) const;
  /// A block K_ab of one element that is added into a slot of the matrix, or a force that is added to a node.
  struct Contribution {
    std::int32_t element;
    std::uint8_t a;  ///< corners of the element
    std::uint8_t b;
  };
  /// Corners of an element, as the assembly numbers them.
  [[nodiscard]] std::span<const int> cornersOf(std::size_t element) const {
    return madeOfCubes() ? std::span<const int>(cube_[element]) : std::span<const int>(tetrahedra_[element].data(), 4);
  }
  [[nodiscard]] std::size_t elementCount() const { return madeOfCubes() ? cube_.size() : tetrahedra_.size(); }
  struct SlotRange {
    std::size_t slot;         ///< in the matrix values
    std::int32_t node;        ///< of a diagonal block; else -1
    std::size_t first, last;  ///< in contributions; of cubes in cubeBlock_,
    std::size_t turned;       ///< of which those from here on are transposed
  };

  void buildStructure();
  std::size_t orderRows(const std::vector<std::vector<int>>& near);
  [[nodiscard]] std::vector<std::vector<int>> neighbours() const;

  std::vector<Vec3> rest_;
  std::vector<Index4> tetrahedra_;
  std::vector<Index8> cube_;
  std::vector<bool> fixed_;
  Material material_;
  std::variant<TetrahedralElements, HexahedralElements> elements_;
  std::vector<double> mass_;
  std::vector<int> row_;
  std::vector<int> freeNode_;  ///< nodes that move, ascending
  BlockMatrix matrix_;
  std::vector<SlotRange> slot_;             ///< blocks with column <= row, in row order
  std::vector<std::size_t> rowSlot_;        ///< per row: the first of its places in the next two; and the end
  std::vector<int> slotColumn_;             ///< columns of a row's blocks up to the diagonal, ascending
  std::vector<std::size_t> slotPlace_;      ///< and where they stand in the matrix values
  std::vector<std::size_t> elementSlot_;    ///< of the blocks of each element's corners, row by row; noSlot where fixed
                                            ///< or right of the diagonal
  std::vector<Contribution> contribution_;  ///< of tetrahedra
  std::vector<std::uint32_t> cubeBlock_;    ///< of cubes: which of their blocks, 36 of each, are added into a slot
  std::vector<std::size_t> incidentStart_;  ///< per node
  std::vector<Contribution> incident_;      ///< element and corner of each incident element
};

/// Everything of one solid that changes.
struct SolidState {
  std::vector<Vec3> position;           ///< in W (m)
  std::vector<Vec3> velocity;           ///< (m/s)
  std::vector<RotationGroup> rotation;  ///< co-rotation of each element, warm start of the next step's
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

/// A place inside one element of a solid: its corners and their shares.
struct SolidPlace {
  int element = -1;  ///< its number, where known: then `node` are all its corners in their order
  std::array<int, 8> node{};
  std::array<double, 8> weight{};
  std::size_t count = 0;

  /// A nodal quantity there.
  [[nodiscard]] Vec3 of(std::span<const Vec3> values) const;
};

/// A force at a place of a solid that comes from what is not its own, such as a spring to another body, linearised over
/// a step: f = force - damper v, v the place's velocity at the step's end. A spring of stiffness matrix K and damping C
/// gives damper = h K + C: implicit on the solid's side.
struct Attachment {
  SolidPlace place;
  Vec3 force = Vec3::Zero();   ///< N
  Mat3 damper = Mat3::Zero();  ///< N s/m, symmetric, positive semidefinite
};

/// Attachments that answer to one another, for what they are attached to moves as one:
///   f_i = force_i - sum_j damper_ij v_j, v_j the velocity of place j at the step's end.
struct JointAttachment {
  std::vector<SolidPlace> place;
  std::vector<Vec3> force;     ///< per place (N)
  std::vector<double> damper;  ///< 3 n x 3 n, row-major, symmetric, positive semidefinite (N s/m)

  [[nodiscard]] Mat3 block(std::size_t i, std::size_t j) const;
};

/// What a step of a solid depends on besides its own model and state.
struct Surroundings {
  std::span<const Attachment> attachments = {};
  std::span<const double> fill = {};  ///< share of each cube that is there; empty: all of it
  std::span<const JointAttachment> joints = {};
};

/// Implicit Euler, one linearisation a step (Baraff and Witkin 1998): with h = dt,
///   [(1 + alpha h) M + (h^2 + beta h) K] dv = h (f_external + f(x + (h + beta) v) - alpha M v),  v += dv,  x += h v,
/// where K and f are co-rotational with the rotations of x; attachments add h damper to the left and
/// h (force - damper v) to the right, joints the same with their blocks. Nodes that only empty cubes hold stay where
/// they are. Holds the matrix of the step for contact.
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
                         std::span<const Vec3> external, const Settings& settings, Executor& executor,
                         const Surroundings& surroundings = {});

  /// Velocities that the step ends with, as far as they are known: free motion and what push() added since.
  [[nodiscard]] const std::vector<Vec3>& freeVelocity() const { return freeVelocity_; }

  /// Adds the answer to impulses on the nodes to freeVelocity(): dv = A^-1 impulse. @pre freeMotion() of this step was
  /// called. @param impulse per node (N s)
  SolveReport push(const SolidModel& model, std::span<const Vec3> impulse, const Settings& settings);

  /// Velocity responses to up to eight unit impulses, each spread over nodes: column k answers impulse[k].
  /// @pre freeMotion() of this step was called.
  struct Impulse {
    static constexpr std::size_t mostNodes = 24;  ///< a triangle whose corners lie in three cubes
    std::array<int, mostNodes> node{};
    std::array<double, mostNodes> weight{};  ///< share of each node
    std::size_t count = 0;                   ///< how many of them count
    Vec3 impulse = Vec3::Zero();             ///< N s
  };
  SolveReport responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                        std::vector<std::vector<Vec3>>& response);

  /// v = freeVelocity() + correction (or nothing), x += h v. Cubes' corners are held back to 5 m/s, nodes of tetrahedra
  /// to as much beyond the mean of all. Values that are not finite stop the node instead of entering State.
  /// @return false when that happened.
  bool advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step);
  /// The largest that the last advance() held back of nodes with a tenth of their mass at least (m/s); 0: none.
  [[nodiscard]] double heldBack() const { return heldBack_; }

 private:
  void assemble(const SolidModel& model, const Settings& settings, const Surroundings& surroundings,
                Executor& executor);
  void addAttachments(const SolidModel& model, const Settings& settings, std::span<const Attachment> attachments);
  void addJoint(const SolidModel& model, const Settings& settings, const JointAttachment& joint);
  bool addToElement(const SolidModel& model, const Attachment& attachment, double step);
  void addPair(const SolidModel& model, const SolidPlace& p, const SolidPlace& q, const Mat3& damper, double step);
  void addBlock(const SolidModel& model, const SolidModel::Contribution& contribution, std::array<float, 9>& block,
                float lambda, float mu) const;
  void addCubes(const SolidModel& model, const SolidModel::SlotRange& range, std::array<float, 9>& block,
                float scale) const;
  [[nodiscard]] Vec3 cornerForce(const SolidModel& model, const SolidModel::Contribution& contribution) const;

  std::vector<ElementResult> element_;
  std::vector<HexahedronResult> hexahedron_;
  std::vector<HexahedronBlocks> hexahedronBlock_;
  std::vector<double> mass_;  ///< of the nodes, where cubes are not full
  std::vector<Vec3> load_;    ///< on the nodes from outside (N)
  std::vector<float> values_;
  std::vector<ExtraBlock> extra_;  ///< of joints between nodes that share no element
  std::vector<float> b_, x_;
  std::vector<Vec3> freeVelocity_;
  double heldBack_ = 0.0;
  ConjugateGradient cg_;
};

}  // namespace calot

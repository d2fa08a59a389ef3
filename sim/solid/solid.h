// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a deformable solid by implicit Euler, with its attachments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/solid/coarse_lattice.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/solid_model.h"

namespace calot {

class SystemCoupling;

/// A material point of a solid: the corners of its element and their weights.
struct MaterialPoint {
  int element = -1;  ///< index, if known: then `node` lists all its corners in order
  std::array<int, 8> node{};
  std::array<double, 8> weight{};
  std::size_t count = 0;

  /// A nodal quantity there.
  [[nodiscard]] Vec3 of(std::span<const Vec3> values) const;
};

/// An external force at a material point, such as a spring to another body, linearised over a step: f = force - damper
/// v, with v the point's velocity at the end of the step. A spring of stiffness matrix K and damping C gives damper = h
/// K + C, implicit on the solid's side.
struct Attachment {
  MaterialPoint point;
  Vec3 force = Vec3::Zero();   ///< N
  Mat3 damper = Mat3::Zero();  ///< N s/m, symmetric, positive semidefinite
};

/// Coupled attachments, to a body that responds as one:
///   f_i = force_i - sum_j damper_ij v_j, v_j the velocity of point j at the end of the step.
struct JointAttachment {
  std::vector<MaterialPoint> point;
  std::vector<Vec3> force;     ///< per point (N)
  std::vector<double> damper;  ///< 3 n x 3 n, row-major, symmetric, positive semidefinite (N s/m)

  [[nodiscard]] Mat3 block(std::size_t i, std::size_t j) const;
};

/// Inputs of a step besides the solid's own model and state.
struct Surroundings {
  std::span<const Attachment> attachments = {};
  std::span<const double> fill = {};  ///< remaining share of each cube; empty span: all full
  std::span<const JointAttachment> joints = {};
};

/// Implicit Euler, one linearisation a step (Baraff and Witkin 1998): with h = dt,
///   [(1 + alpha h) M + (h^2 + beta h) K] dv = h (f_external + f(x + (h + beta) v) - alpha M v),  v += dv,  x += h v,
/// where K and f are co-rotational with the rotations of x; attachments add h damper to the left and h (force - damper
/// v) to the right, joints the same with their blocks. Empty cubes, and nodes that belong only to them, are not part of
/// the system: such nodes keep their velocity. The matrix of the step is kept for contact.
class SolidSolver {
 public:
  SolidSolver() = default;
  SolidSolver(const SolidSolver&) = delete;  // points into itself
  SolidSolver& operator=(const SolidSolver&) = delete;

  struct Settings {
    double step = 0.01;  ///< h (s)
    double tolerance = 1e-4;
    std::uint32_t cap = 200;
    int rotationSweeps = 2;
    bool lattice = true;  ///< where CoarseLattice::isWorthwhile()
    /// Absolute tolerance: the error's energy is that of the whole solid moving at this speed (m/s).
    double speedTolerance = 0.0;
    bool goesOn = false;  ///< SolveGoal::goesOn
  };

  /// Precomputes the coarse lattice of a large model, which its first step would otherwise do.
  void precompute(const SolidModel& model, const Settings& settings, Executor& executor);

  /// Assembles at the state's position and computes the velocity without contact into freeVelocity().
  /// @param external forces on the nodes besides gravity (N), or empty.
  SolveReport solveUnconstrained(const SolidModel& model, SolidState& state, const Vec3& gravity,
                                 std::span<const Vec3> external, const Settings& settings, Executor& executor,
                                 const Surroundings& surroundings = {});

  /// The first half of solveUnconstrained(): assembles, without a solve. @pre then solveJoined()
  void assembleUnconstrained(const SolidModel& model, SolidState& state, const Vec3& gravity,
                             std::span<const Vec3> external, const Settings& settings, Executor& executor,
                             const Surroundings& surroundings = {});
  /// The first half of that: the solid by itself, with its rotations (which State gets in the second), forces of its
  /// elements and its stiffness. @param fill as of the surroundings
  void linearise(const SolidModel& model, const SolidState& state, const Settings& settings,
                 std::span<const double> fill, Executor& executor);
  /// The second half: all that acts on it. @pre linearise() at this State
  void load(const SolidModel& model, SolidState& state, const Vec3& gravity, std::span<const Vec3> external,
            const Settings& settings, Executor& executor, const Surroundings& surroundings);
  /// The first half of applyImpulses(): takes the impulses, without a solve. @param impulse per node, or empty: none
  void takeImpulses(std::span<const Vec3> impulse);

  /// A coupling of two of the solids of solveJoined(), by their numbers, or of one with itself.
  struct Coupled {
    std::size_t first, second;
    SystemCoupling& by;
  };
  /// Solves what assembleUnconstrained() or takeImpulses() of each has set up, as one linear system with the couplings,
  /// and adds the solution to each freeVelocity(). Without couplings and of one solid, this is the second half of
  /// solveUnconstrained() and of applyImpulses().
  static SolveReport solveJoined(std::span<SolidSolver* const> solids, std::span<const Coupled> couplings,
                                 const Settings& settings);

  /// The system of this step: of the whole solid, or of the remaining cubes. @pre assembleUnconstrained()
  [[nodiscard]] const SolidSystem& system() const { return *system_; }
  /// Changes whenever system() does.
  [[nodiscard]] std::uint64_t systemVersion() const { return systemVersion_; }

  /// Velocities at the end of the step: unconstrained motion plus what applyImpulses() has added so far.
  [[nodiscard]] const std::vector<Vec3>& freeVelocity() const { return freeVelocity_; }

  /// Adds the response to impulses on the nodes to freeVelocity(): dv = A^-1 impulse. @pre solveUnconstrained() of this
  /// step was called. @param impulse per node (N s)
  SolveReport applyImpulses(std::span<const Vec3> impulse, const Settings& settings);

  /// Velocity responses to up to eight impulses, each distributed over nodes: response[k] belongs to impulse[k].
  /// @pre solveUnconstrained() of this step was called.
  struct Impulse {
    static constexpr std::size_t maxNodes = 40;  ///< 24: a triangle whose corners lie in three cubes; pressedPatch()
    std::array<int, maxNodes> node{};
    std::array<double, maxNodes> weight{};  ///< share of each node
    std::size_t count = 0;                  ///< number of nodes used
    Vec3 impulse = Vec3::Zero();            ///< N s

    /// A nodal quantity there.
    [[nodiscard]] Vec3 of(std::span<const Vec3> values) const;
  };
  SolveReport responses(const SolidModel& model, std::span<const Impulse> impulses, const Settings& settings,
                        std::vector<std::vector<Vec3>>& response);

  /// v = freeVelocity() + correction (or no correction), x += h v. The speed of cubes' corners is clamped to 5 m/s,
  /// that of tetrahedral nodes to 5 m/s relative to the mean of all. A node whose values are not finite is stopped, so
  /// that these never enter State.
  /// @return false when that happened.
  bool advance(const SolidModel& model, SolidState& state, std::span<const Vec3> correction, double step);
  /// Greatest speed that the last advance() clamped, of nodes with at least a tenth of their mass (m/s); 0: none.
  [[nodiscard]] double heldBack() const { return heldBack_; }

 private:
  void chooseSystem(const SolidModel& model, std::span<const double> fill);
  void addAttachments(const Settings& settings, std::span<const Attachment> attachments);
  void addJoint(const Settings& settings, const JointAttachment& joint);
  void addSolution();
  bool addToElement(const Attachment& attachment, double step);
  void addPair(const MaterialPoint& p, const MaterialPoint& q, const Mat3& damper, double step);
  [[nodiscard]] Vec3 cornerForce(const SolidModel& model, const SolidSystem::Contribution& contribution) const;

  const SolidSystem* system_ = nullptr;  ///< of this step: the model's, or part_
  SolidSystem part_;                     ///< of the remaining cubes
  std::uint64_t systemVersion_ = 0;
  std::vector<std::uint8_t> present_;    ///< per cube: is it in part_?
  std::vector<RotationGroup> rotation_;  ///< as linearise() left them
  std::vector<ElementResult> element_;
  std::vector<HexahedronResult> hexahedron_;
  std::vector<double> mass_;  ///< of the nodes, if cubes are not full
  std::vector<Vec3> load_;    ///< external forces on the nodes (N)
  StiffnessAssembly stiffness_;
  std::vector<float> values_;      ///< of the matrix
  std::vector<ExtraBlock> extra_;  ///< of joints between nodes that share no element
  std::vector<float> b_, x_;
  std::vector<Vec3> freeVelocity_;
  double heldBack_ = 0.0;
  double wholeMass_ = 0.0;  ///< of the solid at rest (kg)
  ConjugateGradient cg_;
  std::optional<CoarseLattice> lattice_;
  const SolidModel* latticeModel_ = nullptr;  ///< it was built for
  StiffnessAssembly::Scale latticeScale_;     ///< of the matrix it was built for
};

/// Cache of a scene's rest compliances, shared by steppers. They depend on the Model alone, so every run of it can have
/// them from any other.
class ComplianceStore {
 public:
  ComplianceStore() = default;
  ComplianceStore(const ComplianceStore&) = delete;
  ComplianceStore& operator=(const ComplianceStore&) = delete;
  virtual ~ComplianceStore() = default;

  /// The column of a node (RestCompliance), or null: the caller then computes it. It stays where it is for as long as
  /// the store is there. Steppers of several threads may call at the same time.
  /// @param solid organs of the Model, then its bodies of fat
  [[nodiscard]] virtual const float* find(std::size_t solid, std::size_t node) = 0;
  /// Takes a column that find() did not have. @returns the one that is kept, with the same numbers
  virtual const float* keep(std::size_t solid, std::size_t node, std::vector<float> column) = 0;
};

/// A solid's part of a store; of none, the solid keeps its columns itself.
struct ComplianceShelf {
  ComplianceStore* store = nullptr;
  std::size_t solid = 0;
};

/// Compliance of a solid in its reference configuration, rotated with its nodes (compliance warping).
///
/// Solving the step's own matrix for each row of the contact problem would cost many times the motion itself. The
/// reference configuration never changes, so its compliance C = A_rest^-1 is computed once for each node that is ever
/// touched and rotated with the nodes (Saupin, Duriez, Cotin and Grisoni 2008):
///   (A^-1)_ab ~ R_a C_ab R_b^T.
/// Only contact forces depend on it; their effect on the solid is solved with the step's own matrix.
class RestCompliance {
 public:
  /// @param model outlives this. Assembles A in the reference configuration; columns are computed on demand.
  /// @param surroundings attachments and fill in the reference configuration: without its springs, a solid without
  /// fixed nodes would respond as a free body
  /// @param shelf where columns are kept; its store outlives this
  RestCompliance(const SolidModel& model, const SolidSolver::Settings& settings, Executor& executor,
                 const Surroundings& surroundings = {}, const ComplianceShelf& shelf = {});

  /// Computes missing columns of these nodes, eight right-hand sides at a time. A column depends on the model alone,
  /// not on the order of requests.
  void precomputeCompliance(std::span<const int> nodes);

  /// C_ab: velocity of node a (m/s) for an impulse on node b (N s). @pre precomputeCompliance() was called for b
  [[nodiscard]] Mat3 block(int a, int b) const;
  /// The blocks between some nodes and others, row-major, at 9 (i b.size() + j). @param out at least that many numbers
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const;

 private:
  const SolidModel& model_;
  SolidSolver::Settings settings_;
  SolidSolver solver_;
  ComplianceShelf shelf_;
  std::vector<const float*> column_;       ///< per node: 9 numbers for each node, row-major; null: not asked for yet
  std::vector<std::vector<float>> fresh_;  ///< per node: its column that is being computed, or that no store keeps
  std::vector<std::pair<std::size_t, std::size_t>> pending_;  ///< requested nodes and axes
  std::vector<SolidSolver::Impulse> impulses_;
  std::vector<std::vector<Vec3>> response_;
};

/// Rotation of a node: the mean of its tetrahedra's co-rotations, as a unit quaternion.
Quat nodeRotation(const SolidModel& model, const SolidState& state, int node);

/// Isotropic dampers between points of two solids, in the matrix of both as one system: the blocks beside the solids'
/// own matrices,
///   A_pq = -h sum of c_s w_sp w_sq I   over the dampers s, for node p of the first solid and q of the second.
/// Each damper also enters the solids' own matrices, as an Attachment.
class PointCoupling final : public SystemCoupling {
 public:
  /// Structure of the blocks. @param first, second the systems of the solids' steps @param points per damper: in the
  /// first solid, in the second
  PointCoupling(const SolidSystem& first, const SolidSystem& second,
                std::span<const std::array<MaterialPoint, 2>> points);

  /// Values of a step. @param damper per damper (N s/m) @param step h (s)
  void assemble(std::span<const double> damper, double step);

  /// Adds the blocks' part of the product with the present search directions, both ways.
  void addTo(ConjugateGradient& first, ConjugateGradient& second) override;

 private:
  /// Rows of one solid that any block has, with direction and product.
  struct Side {
    std::vector<std::size_t> row;  ///< ascending
    std::vector<FourFloats> direction, product;

    void gather(const ConjugateGradient& from);
    void scatter(ConjugateGradient& to) const;
  };
  /// Share of a damper in a block.
  struct Share {
    std::uint32_t block;
    float weight;
  };

  Side side_[2];
  std::vector<std::uint32_t> first_;   ///< per row of the first solid: its first block; and the end
  std::vector<std::uint32_t> column_;  ///< per block: number of the row of the second solid
  std::vector<float> value_;           ///< per block
  std::vector<Share> share_;           ///< by dampers
  std::vector<std::uint32_t> start_;   ///< per damper: its first share; and the end
};

}  // namespace calot

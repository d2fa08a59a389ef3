// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a deformable solid by implicit Euler, with its attachments.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
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
  void assemble(const SolidModel& model, const SolidState& state, const Settings& settings,
                const Surroundings& surroundings, Executor& executor);
  void addAttachments(const Settings& settings, std::span<const Attachment> attachments);
  void addJoint(const Settings& settings, const JointAttachment& joint);
  void addSolution();
  bool addToElement(const Attachment& attachment, double step);
  void addPair(const MaterialPoint& p, const MaterialPoint& q, const Mat3& damper, double step);
  [[nodiscard]] Vec3 cornerForce(const SolidModel& model, const SolidSystem::Contribution& contribution) const;

  const SolidSystem* system_ = nullptr;  ///< of this step: the model's, or part_
  SolidSystem part_;                     ///< of the remaining cubes
  std::uint64_t systemVersion_ = 0;
  std::vector<std::uint8_t> present_;  ///< per cube: is it in part_?
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

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// One implicit Euler step of vessels with a direct solver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"
#include "sim/vessel/block_tree.h"

namespace calot {

/// A spring between a node and a point of another body (surrounding tissue, another organ), implicit on this side.
struct BeamAttachment {
  int node = 0;
  double stiffness = 0.0;        ///< N/m; any size is stable
  double damping = 0.0;          ///< N s/m
  Vec3 target = Vec3::Zero();    ///< position of that point at the beginning of the step, in W (m)
  Vec3 velocity = Vec3::Zero();  ///< its velocity in this step (m/s)
};

/// Loads on vessels in one step, besides contact. Spans may be empty.
struct BeamLoads {
  Vec3 gravity = Vec3::Zero();   ///< m/s^2
  std::span<const Vec3> force;   ///< per node, in W (N)
  std::span<const Vec3> torque;  ///< per node, in W (N m)
  std::span<const BeamAttachment> attachments;
};

/// Results of a step.
struct BeamReport {
  bool finite = true;           ///< false: a node with values that are not finite was stopped
  bool limited = false;         ///< true: a piece moved too fast for the step and was slowed down
  double requestedSpeed = 0.0;  ///< greatest speed before limiting, if beyond any plausible tissue speed (m/s); else 0
  int torn = -1;                ///< element that tore in this step; -1: none
  double maxStrain = 0.0;       ///< greatest stretch of any whole element, positive in tension
  int maxStrainElement = -1;    ///< its element
  double maxTension = 0.0;      ///< N
  int maxTensionElement = -1;   ///< its element
  double maxSpeed = 0.0;        ///< of a node (m/s)
};

/// With h = dt, u the velocities and angular velocities of all nodes and K the Gauss-Newton stiffness of
/// sim/vessel/beam_element.h, K_g that of chords in tension, k and c those of the attachments:
///   [(1 + alpha h) M + (h^2 + beta h) K + h^2 (K_g + k) + h c] du
///     = h (f_external + f(x) - (h + beta) K u - h K_g u - alpha M u + attachments at x + h u),
///   u += du,  x += h v,  q = rotated(q, h w).
/// One linearisation a step, as for solids. The matrix is factorised once a step, exactly, and kept for contact. After
/// the first step with a model nothing allocates; nothing throws.
class BeamSolver {
 public:
  /// Factorises the matrix at the state and computes the velocities without contact.
  /// @return false if the matrix was not positive definite (values near overflow).
  bool solveUnconstrained(const BeamModel& model, const BeamState& state, const BeamLoads& loads, double step);

  /// Velocities at the end of the step: unconstrained motion plus what applyImpulses() has added so far.
  [[nodiscard]] const std::vector<Vec3>& freeVelocity() const { return freeVelocity_; }

  /// Adds the response to impulses on the nodes. @pre solveUnconstrained() of this step was called. @param impulse
  /// per node (N s)
  void applyImpulses(const BeamModel& model, std::span<const Vec3> impulse);
  /// The matrix of this step, factorised. @pre solveUnconstrained() of this step was called
  [[nodiscard]] const BlockTree& matrix() const { return tree_; }

  /// Computes the columns that block() needs for impulses on these nodes, each once per step. @pre
  /// solveUnconstrained() of this step
  void precomputeCompliance(const BeamModel& model, std::span<const int> nodes);

  /// C_ab, identical to that of applyImpulses(): velocity of node a (m/s) per impulse on node b (N s). @pre
  /// precomputeCompliance() was called for b
  [[nodiscard]] Mat3 block(int a, int b) const;

  /// Moves the nodes, measures strains and tears the element that exceeds its ultimate strain most, if any. Only
  /// one tears per step, because the others then slacken. A node whose values are not finite is stopped, so that
  /// these never enter State.
  BeamReport advance(const BeamModel& model, BeamState& state);

  /// Per element after advance(): tension (N) and stretch; 0 where parted.
  [[nodiscard]] const std::vector<double>& tension() const { return tension_; }
  [[nodiscard]] const std::vector<double>& strain() const { return strain_; }

 private:
  void assembleNodes(const BeamModel& model, const BeamState& state, const BeamLoads& loads);
  void assembleElement(const BeamModel& model, const BeamState& state, std::size_t index);
  void solveInto(const BeamModel& model);
  bool limitPieces(const BeamModel& model, const BeamState& state);

  double step_ = 0.0;
  BlockTree tree_;
  std::vector<Vector6> right_;
  std::vector<Vec3> freeVelocity_;
  std::vector<Vec3> freeAngularVelocity_;
  std::vector<double> tension_;
  std::vector<double> strain_;
  std::vector<int> columnOf_;   ///< per node: index of its column; -1: not computed in this step
  std::vector<double> column_;  ///< 9 numbers for each node, column after column
  std::size_t columns_ = 0;
  std::vector<int> piece_;      ///< per node: first node of its piece
  std::vector<double> excess_;  ///< per piece, at its first node
};

}  // namespace calot

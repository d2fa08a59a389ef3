// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Euler over one step of vessels, solved directly.
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

/// A spring between a node and a place of something else (tissue around it, another organ), implicit on this side.
struct BeamAttachment {
  int node = 0;
  double stiffness = 0.0;        ///< N/m; any size is stable
  double damping = 0.0;          ///< N s/m
  Vec3 target = Vec3::Zero();    ///< where the place is at the step's beginning, in W (m)
  Vec3 velocity = Vec3::Zero();  ///< at which it moves in this step (m/s)
};

/// What acts on vessels in one step, besides contact. Spans may be empty.
struct BeamLoads {
  Vec3 gravity = Vec3::Zero();   ///< m/s^2
  std::span<const Vec3> force;   ///< per node, in W (N)
  std::span<const Vec3> torque;  ///< per node, in W (N m)
  std::span<const BeamAttachment> attachments;
};

/// What a step left behind.
struct BeamReport {
  bool finite = true;           ///< false: some node had to be stopped
  bool limited = false;         ///< true: some piece moved too fast for the step and was slowed down
  double asked = 0.0;           ///< largest speed before that, where no tissue moves as fast (m/s); else 0
  int torn = -1;                ///< element that tore in this step; -1: none
  double largestStrain = 0.0;   ///< over whole elements: stretch, positive when pulled
  int mostStrained = -1;        ///< its element
  double largestTension = 0.0;  ///< N
  int mostTense = -1;           ///< its element
  double largestSpeed = 0.0;    ///< of a node (m/s)
};

/// With h = dt, u the velocities and angular velocities of all nodes and K the Gauss-Newton stiffness of
/// sim/vessel/beam_element.h, K_g that of pulled chords, k and c those of the attachments:
///   [(1 + alpha h) M + (h^2 + beta h) K + h^2 (K_g + k) + h c] du
///     = h (f_external + f(x) - (h + beta) K u - h K_g u - alpha M u + attachments at x + h u),
///   u += du,  x += h v,  q = turned(q, h w).
/// One linearisation a step, as for solids. The matrix is factorised once a step, exactly, and kept for contact.
/// After the first step with a model nothing allocates; nothing throws.
class BeamSolver {
 public:
  /// Factorises at the state and computes the velocities without contact.
  /// @return false where the matrix was not positive definite (numbers near the end of their range).
  bool solveUnconstrained(const BeamModel& model, const BeamState& state, const BeamLoads& loads, double step);

  /// Velocities that the step ends with, as far as they are known: free motion and what push() added since.
  [[nodiscard]] const std::vector<Vec3>& freeVelocity() const { return freeVelocity_; }

  /// Adds the answer to impulses on the nodes. @pre solveUnconstrained() of this step was called. @param impulse per
  /// node (N s)
  void push(const BeamModel& model, std::span<const Vec3> impulse);

  /// Works out what block() needs for impulses on these nodes, once a step each. @pre solveUnconstrained() of this step
  void precomputeCompliance(const BeamModel& model, std::span<const int> nodes);

  /// C_ab, exactly that of push(): velocity of node a (m/s) for an impulse on node b (N s). @pre b was required
  [[nodiscard]] Mat3 block(int a, int b) const;

  /// Moves the nodes, measures strains, and tears the element that exceeds its ultimate strain most, if any: one a
  /// step, since the rest slackens then. Values that are not finite stop the node instead of entering State.
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
  std::vector<Vec3> freeSpin_;
  std::vector<double> tension_;
  std::vector<double> strain_;
  std::vector<int> columnOf_;   ///< per node: which of the columns, -1: not asked for in this step
  std::vector<double> column_;  ///< 9 numbers for each node, column after column
  std::size_t columns_ = 0;
  std::vector<int> piece_;      ///< per node: first node of the piece that it belongs to
  std::vector<double> excess_;  ///< per piece, at its first node
};

}  // namespace calot

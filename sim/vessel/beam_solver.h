// SPDX-License-Identifier: GPL-3.0-or-later
// One implicit Euler step of vessels with a direct solver.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"

namespace calot {

// Direct solution of A x = b where A is symmetric, positive definite, of 6 x 6 blocks, and its graph is a forest: a
// chain (block-tridiagonal) or branching chains. Eliminating every node before its parent fills nothing in, so block
// Cholesky is exact and linear in the number of nodes.
//
// With A_i the diagonal block of node i, B_i = A_{i,p} its block in the column of its parent p, from the last
// node to the first:
//   L_i L_i^T = A_i,   W_i = L_i^-1 B_i,   A_p -= W_i^T W_i.
// Scalar loops in an order fixed by the source.

/// 6 x 6 block, row-major: translation (0 to 2), then rotation (3 to 5).
using Block6 = std::array<double, 36>;
using Vector6 = std::array<double, 6>;

class BlockTree {
 public:
  /// Three columns of one node's block row and one of padding.
  using Columns = std::array<double, 24>;

  /// Sets all blocks to zero. Allocates only when the number of nodes grows. @param nodes rows of the system
  void reset(std::size_t nodes);

  /// A_i, to be filled before factor().
  [[nodiscard]] Block6& diagonal(std::size_t node) { return diagonal_[node]; }
  /// B_i, to be filled before factor(); stays zero for a root.
  [[nodiscard]] Block6& coupling(std::size_t node) { return coupling_[node]; }

  /// Factorises in place. @param parent per node: a smaller index, or -1
  /// @return false if a pivot was not positive and finite: that unknown is then fixed at zero.
  bool factor(std::span<const int> parent);

  /// Solves in place. @pre factor(); x.size() is the number of nodes
  void solve(std::span<const int> parent, std::span<Vector6> x) const;

  /// A_i'^-1 and A_i'^-1 B_i, with A_i' what elimination of a node's children left of its A_i. @pre factor()
  void eliminate(std::size_t node, Block6& inverse, Block6& gain) const;

  /// Translations of all nodes for unit right-hand sides on the three translations of one node: out[9 a + 3 i + k] is
  /// component i at node a for direction k. @pre factor(). @param out 9 numbers for each node
  void columns(std::span<const int> parent, std::size_t node, std::span<double> out);

 private:
  std::vector<Block6> diagonal_;  ///< after factor(): L_i, reciprocals on its diagonal
  std::vector<Block6> coupling_;  ///< after factor(): W_i
  std::vector<Columns> work_;
};

// A factorised BlockTree for many right-hand sides on a few nodes, in floats: for products within an iterative solve,
// whose vectors are floats.

/// Response of some nodes' translations to impulses on the same nodes. With A_i' what elimination of a node's
/// children left of A_i, and G_i = A_i'^-1 B_i:
///   y_p -= G_i^T y_i from the last node to the first, then x_i = A_i'^-1 y_i - G_i x_p.
/// Products alone, where BlockTree::solve() substitutes number after number. Nodes with none of those below them take
/// no part.
class TreeResponse {
 public:
  /// @param tree after BlockTree::factor() @param parent of its nodes @param touched ascending
  void precompute(const BlockTree& tree, std::span<const int> parent, std::span<const std::uint32_t> touched);

  /// @param push impulses in, response out: three numbers for each touched node @pre precompute()
  void solve(std::span<FourFloats> push);

 private:
  /// Translation, padding, rotation, padding.
  using Motion = std::array<float, 8>;
  using Columns = std::array<Motion, 6>;
  struct Node {
    Columns inverse;           ///< columns of A_i'^-1
    Columns up;                ///< rows of G_i
    Columns down;              ///< columns of G_i
    std::int32_t parent = -1;  ///< among those that take part
  };

  static void sumOf(const Columns& columns, const Motion& x, EightFloats& sum);
  static void solveNodes(std::span<const Node> node, std::span<Motion> x);

  std::vector<Node> node_;
  std::vector<std::int32_t> number_;    ///< per node of the tree: among those that take part, or -1
  std::vector<std::uint32_t> touched_;  ///< among those that take part
  std::vector<Motion> x_;
};

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
/// sim/vessel/beam_state.h, K_g that of chords in tension, k and c those of the attachments:
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

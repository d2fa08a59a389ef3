// SPDX-License-Identifier: GPL-3.0-or-later
// How a solid answers to impulses at rest, turned with its nodes: the compliance on which contact is decided.
//
// Solving the step's own matrix once for each row of the contact problem costs many times the motion itself. Its rest
// shape never changes, so its compliance C = A_rest^-1 is worked out once for each node that is ever touched and
// carried along by the nodes' rotations R (compliance warping; Saupin, Duriez, Cotin and Grisoni 2008):
//   (A^-1)_ab ~ R_a C_ab R_b^T.
// It decides contact forces only; what they do to the solid is solved with the step's own matrix.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sim/solid/solid.h"

namespace calot {

class RestCompliance {
 public:
  /// @param model outlives this. Assembles A at rest; columns come when they are asked for.
  /// @param surroundings what holds the solid besides fixed nodes, and how full its cubes are, at rest: without its
  /// springs, a solid that hangs on nothing else would answer as if it flew freely
  RestCompliance(const SolidModel& model, const SolidSolver::Settings& settings, Executor& executor,
                 const Surroundings& surroundings = {});

  /// Works out the columns of these nodes that are not known yet, eight right-hand sides at a time. A column is a
  /// function of the model alone: in which order and company it is asked for changes nothing.
  void precomputeCompliance(std::span<const int> nodes);

  /// C_ab: velocity of node a (m/s) for an impulse on node b (N s). @pre b was required
  [[nodiscard]] Mat3 block(int a, int b) const;
  /// The blocks between some nodes and others, row-major, at 9 (i b.size() + j). @param out as many numbers or more
  void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const;

 private:
  const SolidModel& model_;
  SolidSolver::Settings settings_;
  SolidSolver solver_;
  std::vector<std::vector<float>> column_;  ///< per node: 9 numbers for each node, row-major; empty: not known
  std::vector<std::pair<std::size_t, std::size_t>> pending_;  ///< nodes and axes that are asked for
  std::vector<SolidSolver::Impulse> impulses_;
  std::vector<std::vector<Vec3>> response_;
};

/// Rotation of a node: the mean of its tetrahedra's co-rotations, as a unit quaternion.
Quat nodeRotation(const SolidModel& model, const SolidState& state, int node);

}  // namespace calot

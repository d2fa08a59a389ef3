// SPDX-License-Identifier: GPL-3.0-or-later
// Compliance of a solid in its reference configuration, rotated with its nodes (compliance warping).
//
// Solving the step's own matrix for each row of the contact problem would cost many times the motion itself. The
// reference configuration never changes, so its compliance C = A_rest^-1 is computed once for each node that is ever
// touched and rotated with the nodes (Saupin, Duriez, Cotin and Grisoni 2008):
//   (A^-1)_ab ~ R_a C_ab R_b^T.
// Only contact forces depend on it; their effect on the solid is solved with the step's own matrix.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sim/solid/solid.h"

namespace calot {

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

}  // namespace calot

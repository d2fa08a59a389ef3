// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Seidel sweeps reduce errors that are smooth over many elements slowly. A coarse lattice over the reference
// configuration removes them directly: besides the sweeps, the preconditioner adds
//   z += Z E^-1 Z^T r,   Z_iq = w_q(X_i) R_i,   E = Z^T A Z at rest,
// with w_q the trilinear shape function of lattice node q at X_i, the reference position of node i, and R_i the
// node's rotation. E is inverted once for all steps (two-level additive Schwarz: Toselli and Widlund 2005, 2.2, with
// a rotated coarse space).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/solid/block_matrix.h"
#include "sim/solid/solid_model.h"
#include "sim/solid/sweeps.h"

namespace calot {

class CoarseLattice {
 public:
  /// True if a lattice pays off. In small solids, sweeps alone are as fast.
  static bool isWorthwhile(const SolidModel& model);

  /// @param rest values of the whole system's matrix in the reference configuration (BlockMatrix)
  /// @pre isWorthwhile(model); the model outlives this
  CoarseLattice(const SolidModel& model, std::span<const float> rest);

  /// Sets the nodes' rotations from those of a few of their elements.
  void rotate(std::span<const RotationGroup> rotation);

  /// c = Z E^-1 Z^T r, both in lanes. Leaves c unchanged if E could not be inverted.
  void apply(const float* r, float* c);

 private:
  static constexpr std::size_t corners = sweeps::Share::corners;
  static constexpr std::size_t sampled = 4;  ///< elements whose rotations a node averages

  void placeNodes();
  bool invert(std::span<const float> rest);

  const SolidModel& model_;
  std::vector<sweeps::Share> share_;                        ///< per row
  std::vector<std::array<std::uint32_t, 2>> edge_;          ///< lattice nodes at the ends of each edge
  std::vector<sweeps::Part> part_;                          ///< rows of each lattice node
  std::vector<std::size_t> start_;                          ///< per lattice node: its first part; and the end
  std::vector<std::array<std::int32_t, sampled>> element_;  ///< per row
  std::vector<float> quaternion_;                           ///< of each slice's rows: w, x, y, z, eight lanes each
  std::vector<float> inverse_;                              ///< E^-1, rows of stride_ numbers; empty: none
  std::size_t stride_ = 0;
  std::vector<float> rotated_, coarse_, solution_, ends_;
};

}  // namespace calot

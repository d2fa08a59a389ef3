// SPDX-License-Identifier: GPL-3.0-or-later
// What Gauss-Seidel sweeps take longest to reduce in a large solid is what is smooth over many elements. A lattice of a
// few cells over the solid at rest takes it in one go: beside the sweeps, the preconditioner adds
//   z += Z E^-1 Z^T r,   Z_iq = w_q(X_i) R_i,   E = Z^T A Z at rest,
// w_q the trilinear share of lattice node q at the place X_i of node i at rest, R_i the node's rotation, so that E is
// inverted once for all steps (two-level additive Schwarz: Toselli and Widlund 2005, 2.2, with a rotated coarse space).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/solid/row_sweeps.h"
#include "sim/solid/solid_model.h"

namespace calot {

class CoarseLattice {
 public:
  /// A smaller solid has none: there sweeps alone take as long.
  static bool isWorthIt(const SolidModel& model);

  /// @param rest values of the whole system's matrix at rest (BlockMatrix)
  /// @pre isWorthIt(model); the model outlives this
  CoarseLattice(const SolidModel& model, std::span<const float> rest);

  /// Takes the nodes' rotations from a few of their elements'.
  void rotate(std::span<const RotationGroup> rotation);

  /// c = Z E^-1 Z^T r, both vectors of the matrix (lanes). Leaves c alone where E could not be inverted.
  void answer(const float* r, float* c);

 private:
  static constexpr std::size_t corners = sweeps::Share::corners;
  static constexpr std::size_t sampled = 4;  ///< elements of a node that tell its rotation

  void placeNodes();
  bool invert(std::span<const float> rest);

  const SolidModel& model_;
  std::vector<sweeps::Share> share_;                        ///< per row
  std::vector<std::array<std::uint32_t, 2>> edge_;          ///< lattice nodes at its ends
  std::vector<sweeps::Part> part_;                          ///< rows of each lattice node
  std::vector<std::size_t> start_;                          ///< per lattice node: its first part; and the end
  std::vector<std::array<std::int32_t, sampled>> element_;  ///< per row
  std::vector<float> quaternion_;                           ///< of each slice's rows: w, x, y, z, eight lanes each
  std::vector<float> inverse_;                              ///< E^-1, rows of stride_ numbers; empty: none
  std::size_t stride_ = 0;
  std::vector<float> turned_, coarse_, answer_, ends_;
};

}  // namespace calot

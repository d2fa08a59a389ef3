// SPDX-License-Identifier: GPL-3.0-or-later
// Co-rotational trilinear hexahedra (cubes of one size at rest) in lanes of eight.
//
// Each cube has one rotation, the polar rotation of its mean deformation gradient, and small strain
// in the rotated frame:
//   f = -fill R (K (R^T x - X) + f_0),   f_0 what the cube carries at rest.
// K integrates the deviatoric part at 2 x 2 x 2 Gauss points, which is exact for a cube, and the volumetric part with
// the mean dilatation (Nagtegaal, Parks and Rice 1974; Hughes 1980, "B-bar"), so that nearly incompressible tissue does
// not lock. All cubes share one K.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/solid/polar.h"
#include "sim/solid/tetrahedral_elements.h"

namespace calot {

/// Nodes of a cube: corner c lies at (c & 1, (c >> 1) & 1, (c >> 2) & 1) edges from corner 0.
using Index8 = std::array<int, 8>;

/// Eight cubes in lanes. Lanes past the last cube repeat it with weight 0.
struct HexahedronGroup {
  std::array<std::array<int, laneCount>, 8> node;
  std::array<double, laneCount> weight;  ///< 1, or 0 where the lane is not used
};

/// K u of a group's cubes at rest, in their frames: of corner a along i at [3 a + i] (N).
using InitialForces = std::array<std::array<double, laneCount>, 24>;

/// Forces of a group, for the assembly.
struct HexahedronResult {
  std::array<std::array<std::array<double, laneCount>, 3>, 8> force;  ///< on the nodes (N)
};

/// Blocks of one cube: fill R K_ab R^T for a <= b (N/m), pairs in the order of pairOf(), entry (i, j) at [3 i + j]. Not
/// in lanes, since the assembly reads cubes one by one.
using HexahedronBlocks = std::array<std::array<float, 9>, 36>;

class HexahedralElements {
 public:
  /// @param edge of the cubes (m). @pre at rest, every cube's nodes lie as Index8 says
  HexahedralElements(std::span<const Index8> cells, double edge, LameConstants material);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double edge() const { return edge_; }
  [[nodiscard]] const std::vector<HexahedronGroup>& groups() const { return groups_; }
  /// Stiffness of a full cube at rest: entry (3 a + i, 3 b + j), corners a, b (N/m).
  [[nodiscard]] const std::array<std::array<double, 24>, 24>& stiffness() const { return stiffness_; }

  /// Index of the block of corners a <= b.
  static constexpr std::size_t pairOf(std::size_t a, std::size_t b) { return 8 * a - a * (a - 1) / 2 + (b - a); }

  /// For each group: rotates `rotation` towards the polar rotation of the mean deformation gradient at `position` by
  /// `sweeps` Newton steps, then computes forces at position + lookAhead * velocity. Skips empty groups.
  /// @param fill per cube, 0 to 1: remaining share of stiffness and mass; empty span: all full
  /// @param rotation in: last step's; out: this step's (unit)
  void evaluate(std::span<const Vec3> position, std::span<const Vec3> velocity, double lookAhead, int sweeps,
                std::span<const double> fill, std::span<RotationGroup> rotation, std::span<HexahedronResult> result,
                Executor& executor) const;

  /// Gives each cube the forces at rest, f_0 = K u, that these displacements of the nodes (m) would add to a full one.
  void preload(std::span<const Vec3> displacement);

  /// Fill of a group's cubes, by lane: 0 where a lane is not used.
  [[nodiscard]] std::array<double, laneCount> fillOf(std::size_t group, std::span<const double> fill) const;
  /// Stiffness of a group's cubes, rotated by `rotation`. @param fill by lane @param out per lane
  void blocks(const RotationGroup& rotation, const std::array<double, laneCount>& fill,
              std::span<HexahedronBlocks, laneCount> out) const;

  /// Sum over the cubes of fill times the deformed volume (m^3), trilinear, in order of the cubes.
  [[nodiscard]] double volume(std::span<const Vec3> position, std::span<const double> fill) const;

 private:
  std::size_t count_ = 0;
  double edge_ = 0.0;
  std::vector<HexahedronGroup> groups_;
  std::array<std::array<double, 24>, 24> stiffness_{};
  std::array<Vec3, 8> corner_{};      ///< at rest, from the cube's middle (m)
  std::vector<InitialForces> force_;  ///< f_0 of each group; empty: none
};

}  // namespace calot

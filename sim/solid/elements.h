// SPDX-License-Identifier: GPL-3.0-or-later
// Co-rotational linear tetrahedra (Mueller and Gross 2004, "Interactive virtual materials"; Etzmuss et al. 2003)
// in lanes of eight, and the polar rotation of their deformation gradients.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

/// Unit quaternions (w, x, y, z) of eight elements.
using RotationGroup = std::array<std::array<double, laneCount>, 4>;

/// Deformation gradients F of eight elements: entry (i, j) of lane l stands at [i][j][l].
using DeformationLanes = std::array<std::array<std::array<double, laneCount>, 3>, 3>;

/// Rotates each R towards the polar rotation of F: maximises tr(R^T F) by `sweeps` steps of Newton's method on rotation
/// increments. With B = R^T F, the gradient is a = axial(B - B^T) and the Hessian -(tr(B) I - sym(B)); the increment
/// enters the quaternion as (1, w/2), normalised, so that the result is always orthogonal. Where the Hessian is not
/// positive definite (inverted or very flat elements) the step falls back to a / (|tr B| + |a|): a rotation of bounded
/// angle in the same direction.
///
/// @param q in: start, unit; out: unit
void rotateTowardsPolar(const DeformationLanes& f, int sweeps, RotationGroup& q);

/// Lame constants of an isotropic linear material (Pa).
struct LameConstants {
  double lambda = 0.0;
  double mu = 0.0;
};

/// lambda = E nu / ((1 + nu)(1 - 2 nu)), mu = E / (2 (1 + nu)). @pre E > 0, 0 <= nu < 0.5
LameConstants lameConstants(double youngModulus, double poissonRatio);

/// Eight tetrahedra in lanes. Lanes past the last element repeat it with volume 0.
struct ElementGroup {
  std::array<std::array<int, laneCount>, 4> node;                        ///< node indices
  std::array<std::array<std::array<double, laneCount>, 3>, 4> gradient;  ///< of the shape functions at rest (1/m)
  std::array<double, laneCount> volume;                                  ///< at rest (m^3)
};

/// Stress of a group at rest (Pa): xx, yy, zz, xy, xz, yz.
using InitialStress = std::array<std::array<double, laneCount>, 6>;

/// Forces of an element group, for the right-hand side.
struct ElementResult {
  std::array<std::array<std::array<double, laneCount>, 3>, 4> force;  ///< on the nodes (N)
};

/// Gradients of a group's shape functions, rotated: R grad N_a (1/m).
using RotatedGradients = std::array<std::array<std::array<float, laneCount>, 3>, 4>;

/// The tetrahedra of one solid at rest.
class TetrahedralElements {
 public:
  /// @pre every tetrahedron has positive volume.
  TetrahedralElements(std::span<const Vec3> rest, std::span<const Index4> tetrahedra);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const std::vector<ElementGroup>& groups() const { return groups_; }
  [[nodiscard]] double restVolume(std::size_t element) const {
    return groups_[element / laneCount].volume[element % laneCount];
  }

  /// For each group: rotates `rotation` towards the polar rotation of F(position) by `sweeps` Newton steps, then
  /// computes forces of the linear law in the rotated frame at position + lookAhead * velocity:
  ///   F = sum_a x_a grad_a^T,  eps = sym(R^T F) - I,  sigma = 2 mu eps + lambda tr(eps) I,
  ///   f_a = -V R (sigma + sigma_0 + Omega) grad_a.
  /// The stress at rest sigma_0 adds V sigma_0 : (U - I) to the energy, with U = sym(R^T F): a Biot stress, as sigma
  /// is. Omega is the skew matrix that makes (sigma_0 + Omega) U symmetric, so that the forces are that energy's
  /// gradient and have no moment (Ogden 1984, 3.5; sigma has the axes of U and needs none). With lookAhead = dt + beta
  /// this is the elastic part of the right-hand side of implicit Euler with stiffness damping.
  /// @param rotation in: last step's; out: this step's (unit). It is part of State.
  void evaluate(std::span<const Vec3> position, std::span<const Vec3> velocity, double lookAhead,
                LameConstants material, int sweeps, std::span<RotationGroup> rotation, std::span<ElementResult> result,
                Executor& executor) const;

  /// Gives each element the stress at rest that these displacements of the nodes (m) would: sigma of
  /// eps = sym(sum_a u_a grad_a^T).
  void preload(std::span<const Vec3> displacement, LameConstants material);

  void gradients(std::size_t group, const RotationGroup& rotation, RotatedGradients& out) const;

  /// Sum of signed volumes of the deformed tetrahedra (m^3), in element order.
  [[nodiscard]] double volume(std::span<const Vec3> position) const;

 private:
  std::size_t count_ = 0;
  std::vector<ElementGroup> groups_;
  std::vector<InitialStress> stress_;  ///< sigma_0 of each group; empty: none
};

// Co-rotational trilinear hexahedra (cubes of one size at rest) in lanes of eight.
//
// Each cube has one rotation, the polar rotation of its mean deformation gradient, and small strain
// in the rotated frame:
//   f = -fill R (K (R^T x - X) + f_0),   f_0 what the cube carries at rest.
// K integrates the deviatoric part at 2 x 2 x 2 Gauss points, which is exact for a cube, and the volumetric part with
// the mean dilatation (Nagtegaal, Parks and Rice 1974; Hughes 1980, "B-bar"), so that nearly incompressible tissue does
// not lock. All cubes share one K.

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

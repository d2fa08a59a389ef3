// SPDX-License-Identifier: GPL-3.0-or-later
// Co-rotational linear tetrahedra (Mueller and Gross 2004, "Interactive virtual materials"; Etzmuss et al. 2003)
// in lanes of eight.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/solid/polar.h"

namespace calot {

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

}  // namespace calot

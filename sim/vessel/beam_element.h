// SPDX-License-Identifier: GPL-3.0-or-later
// One element: strains, forces and the stiffness of a step. Internal to this folder.
#pragma once

#include "sim/math/linear.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// Strains of one element, all in W.
struct BeamStrain {
  Vec3 chord = Vec3::Zero();     ///< d (m)
  Vec3 axis = Vec3::Zero();      ///< R_m a
  Vec3 rotation = Vec3::Zero();  ///< R_m P
  Vec3 force = Vec3::Zero();     ///< n: acts on node a along it and on node b against it (N)
  Vec3 moment = Vec3::Zero();    ///< m: acts on node a along it and on node b against it, besides the moment of n (N m)
  double bendRate = 0.0;         ///< 1 + |P|^2: d kappa = bendRate / L R_m^T (w_b - w_a)
  double stretch = 0.0;          ///< |d| / L - 1
  double tension = 0.0;          ///< n along the axis, positive in tension (N)
};

BeamStrain strainOf(const BeamElement& element, const BeamState& state, std::size_t index);

/// With v and w the velocities and angular velocities of the nodes, the material stores and dissipates energy through s
/// = v_b - v_a + G_a w_a + G_b w_b  and  w_b - w_a:
///   force on b: -c s,  moment on a: -G_a^T c s + D (w_b - w_a),  moment on b: -G_b^T c s - D (w_b - w_a).
/// This Gauss-Newton stiffness is positive semidefinite and vanishes for rigid motions. `string` is the only
/// geometric term included: the transverse stiffness of a chord in tension. The other terms of the exact Hessian
/// are at most as large as those included, and the implicit step is stable as long as its matrix has more than
/// half the true stiffness.
struct BeamStiffness {
  Mat3 ga = Mat3::Zero();
  Mat3 gb = Mat3::Zero();
  Mat3 bend = Mat3::Zero();    ///< D (N m)
  Mat3 across = Mat3::Zero();  ///< 1 - axis axis^T
  double stretch = 0.0;        ///< c (N/m)
  double string = 0.0;         ///< N/m, of `across`
};

BeamStiffness stiffnessOf(const BeamElement& element, const BeamStrain& strain, double sleeve);

}  // namespace calot

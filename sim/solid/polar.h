// SPDX-License-Identifier: GPL-3.0-or-later
// Polar rotation of deformation gradients in lanes of eight.
#pragma once

#include <array>

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

}  // namespace calot

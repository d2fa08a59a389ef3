// SPDX-License-Identifier: GPL-3.0-or-later
// Frames along a centre line, in deterministic arithmetic.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// q / |q|.
Quat normalised(const Quat& q);

/// (1 - t) a + t b, normalised, b with the sign nearer to a. For t = 1/2 this is the geodesic mean.
Quat blend(const Quat& a, const Quat& b, double t);

/// Rotation by the smallest angle from unit vector `from` to unit vector `to`; about some normal if they are opposite.
Quat minimalRotation(const Vec3& from, const Vec3& to);

/// A frame with this z axis (unit) whose x axis is as close as possible to the axis of W that is farthest from z.
Quat frameAlong(const Vec3& z);

/// Rotation of b relative to a about axis n by theta: tan(theta/4) n in W (modified Rodrigues parameters; at most 1).
Vec3 quarterTangent(const Quat& a, const Quat& b);

/// q rotated about the vector w in W by the angle whose tangent is |w|: one step of rotation. A rod d whose end
/// moves along a straight line by w x d rotates by exactly that angle, so that positions and orientations stay
/// consistent in large steps.
Quat rotated(const Quat& q, const Vec3& w);

}  // namespace calot

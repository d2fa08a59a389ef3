// SPDX-License-Identifier: GPL-3.0-or-later
// Frames along a centre line, in arithmetic that is the same everywhere.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// q / |q|.
Quat normalised(const Quat& q);

/// (1 - t) a + t b, normalised, b with the sign nearer to a. For t = 1/2 this is the geodesic mean.
Quat blend(const Quat& a, const Quat& b, double t);

/// The least rotation that takes unit vector `from` to unit vector `to`; about any normal where they are opposite.
Quat leastTurn(const Vec3& from, const Vec3& to);

/// A frame with this z axis (unit), its x axis as near as can be to the axis of W that is farthest from z.
Quat frameAlong(const Vec3& z);

/// Rotation of b relative to a about axis n by theta: tan(theta/4) n in W (modified Rodrigues parameters; at most 1).
Vec3 quarterTangent(const Quat& a, const Quat& b);

/// q turned about the vector w in W by the angle whose tangent is |w|: a step of rotation. A rod whose end goes
/// straight ahead by w x d turns by just that angle, so that place and orientation stay together in long steps.
Quat turned(const Quat& q, const Vec3& w);

}  // namespace calot

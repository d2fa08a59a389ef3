// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid instrument through a trocar: the shaft pivots about the port, so the tip's place fixes yaw, pitch and
// insertion; roll about the shaft is what remains of the hand's orientation.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// The shaft reaches at least this far past the port (m).
inline constexpr double leastInsertion = 0.01;

/// Orientation with z along `axis` (unit) and x as near to `roll` (unit) as that allows; where they are parallel, a
/// fixed perpendicular.
Quat alongAxis(const Vec3& axis, const Vec3& roll);

/// Pose in W of an instrument whose tip is meant to be at `tip` and whose hand is turned by `orientation`.
/// A tip nearer to the port than leastInsertion is moved to that distance, along `previousAxis` where the direction is
/// undefined. @param previousAxis unit, from port to tip
Pose throughPort(const Vec3& port, const Vec3& tip, const Quat& orientation, const Vec3& previousAxis);

/// How a displacement of the tip moves points of the shaft: a point at distance s from the port, tip at distance L, is
/// moved by (s / L) (I - a a^T) + a a^T. For a force f on that point this returns the force on the tip that does the
/// same work (the transpose, which is the same matrix).
Vec3 shaftTranspose(const Vec3& axis, double s, double length, const Vec3& f);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Distance of moving tissue to a moving capsule, eight nodes at a time.
#pragma once

#include <span>

#include "sim/math/lanes.h"
#include "sim/math/linear.h"

namespace calot {

/// A capsule that moved from segment p0-p1 to segment q0-q1 (m, W).
struct SweptCapsule {
  Vec3 p0 = Vec3::Zero();
  Vec3 p1 = Vec3::Zero();
  Vec3 q0 = Vec3::Zero();
  Vec3 q1 = Vec3::Zero();
  double radius = 0.0;  ///< m
};

/// Where eight rest nodes lie and lay, and how the tissue is strained there. Coordinate by coordinate.
struct NodeLanes {
  double now[3][laneCount];       ///< deformed positions (m, W)
  double before[3][laneCount];    ///< the same when the capsule was at p (m, W)
  double gradient[9][laneCount];  ///< F = dx/dX, row by row: element 3 r + c is dx_r / dX_c
};

/// Raises out[i] to the tool's potential at node i, where that is higher, for each capsule of the tool:
///
///   (radius - d) / |F^T n|
///
/// d is the distance of x = now[i] to the region that the segment swept *relative to the tissue*: from the previous
/// segment, carried along by x - before[i], to the present one, moving in a straight line; as the two triangles that
/// the four ends span. n is the unit vector from the nearest point to x. The divisor is the rate at which the distance
/// changes in rest space, so what is written there is a distance again; d = 0 leaves it out. Exact for any degenerate
/// sweep: a resting capsule, a sphere, a stroke along the axis.
///
/// @param reach potentials below -reach need not be found (m)
/// @return false: no node is near enough, nothing was written
bool toolPotential(std::span<const SweptCapsule> tool, const NodeLanes& nodes, double reach, double (&out)[laneCount]);

}  // namespace calot

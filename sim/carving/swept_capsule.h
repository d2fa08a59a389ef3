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

/// Current and previous positions of eight nodes and the deformation gradients there, coordinate by coordinate.
struct NodeLanes {
  double now[3][laneCount];       ///< deformed positions (m, W)
  double before[3][laneCount];    ///< the same when the capsule was at p (m, W)
  double gradient[9][laneCount];  ///< F = dx/dX, row by row: element 3 r + c is dx_r / dX_c
};

/// Raises out[i] to the tool's potential at node i, where that is higher, for each capsule of the tool:
///
///   (radius - d) / |F^T n|
///
/// d is the distance of x = now[i] from the region that the segment swept *relative to the tissue*: from the previous
/// segment, translated by x - before[i], to the current one along straight lines, as the two triangles that the four
/// ends span. n is the unit vector from the nearest point to x. The divisor is the rate of change of the distance in
/// the reference configuration, so that the result is again a distance; it is omitted for d = 0. Exact for degenerate
/// sweeps: a capsule that does not move, a sphere, a stroke along the axis.
///
/// @param reach potentials below -reach may be omitted (m)
/// @return false: no node is near enough; `out` is unchanged
bool toolPotential(std::span<const SweptCapsule> tool, const NodeLanes& nodes, double reach, double (&out)[laneCount]);

}  // namespace calot

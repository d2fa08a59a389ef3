// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid instrument through a trocar: the shaft pivots about the port, so the tip's place fixes yaw, pitch and
// insertion; roll about the shaft is what remains of the hand's orientation.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// The shaft reaches at least this far past the port (m).
inline constexpr double minInsertion = 0.01;

/// Orientation with z along `axis` (unit) and x as near to `roll` (unit) as that allows; where they are parallel, a
/// fixed perpendicular.
Quat alongAxis(const Vec3& axis, const Vec3& roll);

/// Pose in W of an instrument whose tip is meant to be at `tip` and whose hand is turned by `orientation`.
/// A tip nearer to the port than minInsertion is moved to that distance, along `previousAxis` where the direction is
/// undefined. @param previousAxis unit, from port to tip
Pose throughPort(const Vec3& port, const Vec3& tip, const Quat& orientation, const Vec3& previousAxis);

/// Jacobian of a point of a tool: displacement of the tip (m), then roll about its axis (rad). The shaft turns
/// about the port, so the point at r from the port follows a displacement d of the tip by
///   ((a x d) / L) x r + a (a . d),   L the tip's distance from the port, a the axis,
/// and a roll by t about the axis by t a x (point - tip).
using ToolRow = Eigen::Matrix<double, 4, 1>;

/// The row that gives the point's displacement along `direction`; its transpose takes a force along `direction` to the
/// force on the tip (N) and the torque about the axis (N m) that do the same work.
/// @param tool pose of frame I; @pre the tip is at least minInsertion from the port
ToolRow toolRow(const Vec3& port, const Pose& tool, const Vec3& point, const Vec3& direction);

/// Angle about the axis of `to` by which the x axis of `from`, made perpendicular to it, meets that of `to` (rad).
double rollBetween(const Quat& from, const Quat& to);

/// The tool after a displacement of its tip and a roll, still through the port.
Pose movedTool(const Vec3& port, const Pose& tool, const Vec3& displacement, double roll);

}  // namespace calot

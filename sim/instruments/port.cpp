// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/port.h"

#include <cmath>

#include "sim/math/elementary.h"

namespace calot {

Quat alongAxis(const Vec3& axis, const Vec3& roll) {
  Vec3 x = roll - axis * axis.dot(roll);
  if (x.norm() < 1e-6) {
    // The direction of W that the axis is farthest from.
    const Vec3 size = axis.cwiseAbs();
    const int k = size[0] <= size[1] && size[0] <= size[2] ? 0 : (size[1] <= size[2] ? 1 : 2);
    x = Vec3::Unit(k) - axis * axis[k];
  }
  x /= x.norm();
  Mat3 r;
  r.col(0) = x;
  r.col(1) = axis.cross(x);
  r.col(2) = axis;
  Quat q(r);
  q.coeffs() /= q.coeffs().norm();
  return q;
}

Pose throughPort(const Vec3& port, const Vec3& tip, const Quat& orientation, const Vec3& previousAxis) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  const Vec3 axis = length > 1e-6 ? Vec3(reach / length) : previousAxis;
  Pose pose;
  pose.position = length >= minInsertion ? tip : Vec3(port + minInsertion * axis);
  pose.orientation = alongAxis(axis, orientation.toRotationMatrix().col(0));
  return pose;
}

ToolRow toolRow(const Vec3& port, const Pose& tool, const Vec3& point, const Vec3& direction) {
  const Vec3 reach = tool.position - port;
  const double length = reach.norm();
  const Vec3 axis = reach / length;
  const Vec3 r = point - port;
  ToolRow row;
  row.head<3>() = r.cross(direction).cross(axis) / length + direction.dot(axis) * axis;
  row[3] = axis.dot((point - tool.position).cross(direction));
  return row;
}

double rollBetween(const Quat& from, const Quat& to) {
  const Mat3 r = to.toRotationMatrix();
  const Mat3 f = alongAxis(r.col(2), from.toRotationMatrix().col(0)).toRotationMatrix();
  return arctangent2(r.col(0).dot(f.col(1)), r.col(0).dot(f.col(0)));
}

Pose movedTool(const Vec3& port, const Pose& tool, const Vec3& displacement, double roll) {
  const Mat3 before = tool.orientation.toRotationMatrix();
  const Pose pose = throughPort(port, tool.position + displacement, tool.orientation, before.col(2));
  if (roll == 0.0) return pose;
  const Mat3 r = pose.orientation.toRotationMatrix();
  return {pose.position, alongAxis(r.col(2), cosine(roll) * r.col(0) + sine(roll) * r.col(1))};
}

}  // namespace calot

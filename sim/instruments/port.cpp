// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/port.h"

#include <cmath>

namespace calot {

Quat alongAxis(const Vec3& axis, const Vec3& roll) {
  Vec3 x = roll - axis * axis.dot(roll);
  if (x.norm() < 1e-6) {
    // Of the three directions of W the one that the axis is farthest from.
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
  pose.position = length >= leastInsertion ? tip : Vec3(port + leastInsertion * axis);
  pose.orientation = alongAxis(axis, orientation.toRotationMatrix().col(0));
  return pose;
}

Vec3 shaftTranspose(const Vec3& axis, double s, double length, const Vec3& f) {
  const double along = axis.dot(f);
  return (s / length) * (f - along * axis) + along * axis;
}

}  // namespace calot

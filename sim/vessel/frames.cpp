// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/frames.h"

#include <cmath>

namespace calot {

Quat normalised(const Quat& q) {
  const double w = q.w();
  const double x = q.x();
  const double y = q.y();
  const double z = q.z();
  const double inverse = 1.0 / std::sqrt((w * w + x * x) + (y * y + z * z));
  return {w * inverse, x * inverse, y * inverse, z * inverse};
}

Quat blend(const Quat& a, const Quat& b, double t) {
  const double dot = (a.w() * b.w() + a.x() * b.x()) + (a.y() * b.y() + a.z() * b.z());
  const double s = 1.0 - t;
  const double u = dot < 0.0 ? -t : t;
  return normalised({s * a.w() + u * b.w(), s * a.x() + u * b.x(), s * a.y() + u * b.y(), s * a.z() + u * b.z()});
}

Quat minimalRotation(const Vec3& from, const Vec3& to) {
  const double dot = from.dot(to);
  if (dot < -0.999999) {
    const Vec3 normal = frameAlong(from) * Vec3::UnitX();
    return {0.0, normal[0], normal[1], normal[2]};
  }
  const Vec3 cross = from.cross(to);
  return normalised({1.0 + dot, cross[0], cross[1], cross[2]});
}

Quat frameAlong(const Vec3& z) {
  const Vec3 size = z.cwiseAbs();
  const int k = size[0] <= size[1] && size[0] <= size[2] ? 0 : (size[1] <= size[2] ? 1 : 2);
  Vec3 x = Vec3::Unit(k) - z * z[k];
  x /= x.norm();
  Mat3 r;
  r.col(0) = x;
  r.col(1) = z.cross(x);
  r.col(2) = z;
  return normalised(Quat(r));
}

Vec3 quarterTangent(const Quat& a, const Quat& b) {
  Quat rotation = b * a.conjugate();
  if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
  return rotation.vec() / (1.0 + rotation.w());
}

Quat rotated(const Quat& q, const Vec3& w) {
  const Quat rotation(1.0 + std::sqrt(1.0 + w.squaredNorm()), w[0], w[1], w[2]);
  return normalised(rotation * q);
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/pointing.h"

#include <algorithm>
#include <cmath>

#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

Quat unit(const Quat& q) {
  const double norm = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  return {q.w() / norm, q.x() / norm, q.y() / norm, q.z() / norm};
}

}  // namespace

Vec3 shaftDirection(const Vec3& port, const Vec3& tip) {
  const Vec3 along = tip - port;
  const double length = along.norm();
  return length > 1e-6 ? Vec3(along / length) : Vec3(-Vec3::UnitY());
}

Quat pointing(const Vec3& port, const Vec3& tip, double roll) {
  const Vec3 z = shaftDirection(port, tip);
  Vec3 x = Vec3::UnitY().cross(z);
  if (x.norm() < 0.02) x = Vec3::UnitZ().cross(z);
  x /= x.norm();
  const Vec3 y = z.cross(x);
  if (roll != 0.0) {
    const Vec3 level = x;
    x = cosine(roll) * level + sine(roll) * y;
  }
  Mat3 axes;
  axes.col(0) = x;
  axes.col(1) = z.cross(x);
  axes.col(2) = z;
  return quaternionOf(axes);
}

Quat alignedToShaft(const Quat& orientation, const Vec3& shaft) {
  const Vec3 z = orientation * Vec3::UnitZ();
  const Vec3 axis = z.cross(shaft);
  const double real = 1.0 + z.dot(shaft);
  if (real < 1e-9) {
    const Vec3 x = orientation * Vec3::UnitX();
    return unit(Quat(0.0, x.x(), x.y(), x.z()) * orientation);
  }
  return unit(unit(Quat(real, axis.x(), axis.y(), axis.z())) * orientation);
}

double rotationDefect(const Mat3& matrix) {
  const double handed = matrix.col(0).cross(matrix.col(1)).dot(matrix.col(2));
  if (handed <= 0.0) return 2.0;
  return (matrix * matrix.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
}

Quat quaternionOf(const Mat3& r) {
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  Quat q;
  if (trace >= r(0, 0) && trace >= r(1, 1) && trace >= r(2, 2)) {
    q = Quat(1.0 + trace, r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  } else if (r(0, 0) >= r(1, 1) && r(0, 0) >= r(2, 2)) {
    q = Quat(r(2, 1) - r(1, 2), 1.0 + r(0, 0) - r(1, 1) - r(2, 2), r(0, 1) + r(1, 0), r(2, 0) + r(0, 2));
  } else if (r(1, 1) >= r(2, 2)) {
    q = Quat(r(0, 2) - r(2, 0), r(0, 1) + r(1, 0), 1.0 - r(0, 0) + r(1, 1) - r(2, 2), r(1, 2) + r(2, 1));
  } else {
    q = Quat(r(1, 0) - r(0, 1), r(2, 0) + r(0, 2), r(1, 2) + r(2, 1), 1.0 - r(0, 0) - r(1, 1) + r(2, 2));
  }
  q = unit(q);
  return q.w() < 0.0 ? Quat(-q.w(), -q.x(), -q.y(), -q.z()) : q;
}

Quat interpolated(const Quat& from, const Quat& to, double s) {
  const double dot = from.w() * to.w() + from.x() * to.x() + from.y() * to.y() + from.z() * to.z();
  const double a = 1.0 - s;
  const double b = dot < 0.0 ? -s : s;
  return unit(
      Quat(a * from.w() + b * to.w(), a * from.x() + b * to.x(), a * from.y() + b * to.y(), a * from.z() + b * to.z()));
}

double minimumJerk(double s) {
  const double t = std::min(notNegative(s), 1.0);
  return t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
}

namespace {

constexpr double twoPi = 6.283185307179586;

}  // namespace

Unsteadiness::Unsteadiness(double amplitude, double lower, double upper, Random& random)
    : amplitude_(amplitude * std::sqrt(2.0 / static_cast<double>(sines))) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < sines; ++i) {
      omega_[axis][i] = twoPi * random.uniform(lower, upper);
      phase_[axis][i] = twoPi * random.uniform();
    }
  }
}

Vec3 Unsteadiness::at(double time) const {
  Vec3 sum = Vec3::Zero();
  if (amplitude_ == 0.0) return sum;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double total = 0.0;
    for (std::size_t i = 0; i < sines; ++i) total += sine(omega_[axis][i] * time + phase_[axis][i]);
    sum[static_cast<Eigen::Index>(axis)] = amplitude_ * total;
  }
  return sum;
}

}  // namespace calot::recorder

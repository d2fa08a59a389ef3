// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/camera_rig.h"

namespace calot::recorder {
namespace {

Eigen::Vector2d bent(const CameraLens& lens, const Eigen::Vector2d& x) {
  const auto [k1, k2, p1, p2] = lens.distortion;
  const double r2 = x.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * k2);
  return {x[0] * radial + 2.0 * p1 * x[0] * x[1] + p2 * (r2 + 2.0 * x[0] * x[0]),
          x[1] * radial + 2.0 * p2 * x[0] * x[1] + p1 * (r2 + 2.0 * x[1] * x[1])};
}

}  // namespace

Eigen::Vector2d projected(const CameraLens& lens, const Vec3& point) {
  return bent(lens, point.head<2>() / point.z()).cwiseProduct(lens.focal) + lens.centre;
}

Eigen::Vector2d undistorted(const CameraLens& lens, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d seen = (pixel - lens.centre).cwiseQuotient(lens.focal);
  Eigen::Vector2d x = seen;
  // Fixed point; a webcam's distortion contracts by a factor of five or more each time.
  constexpr int rounds = 25;
  for (int i = 0; i < rounds; ++i) x += seen - bent(lens, x);
  return x;
}

}  // namespace calot::recorder

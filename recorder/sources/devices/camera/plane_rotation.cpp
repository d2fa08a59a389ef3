// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/plane_rotation.h"

#include <cmath>

namespace calot::recorder {

Mat3 planeRotation(const Vec3& across, const Vec3& up) {
  // The square root of a positive 2x2 matrix S is (S + d I) / sqrt(tr S + 2 d) with d = sqrt(det S).
  const double aa = across.squaredNorm(), uu = up.squaredNorm(), au = across.dot(up);
  const double d = std::sqrt(aa * uu - au * au);
  const double scale = 1.0 / (d * std::sqrt(aa + uu + 2.0 * d));
  Mat3 rotation;
  rotation.col(0) = scale * ((uu + d) * across - au * up);
  rotation.col(1) = scale * ((aa + d) * up - au * across);
  rotation.col(2) = rotation.col(0).cross(rotation.col(1));
  return rotation;
}

}  // namespace calot::recorder

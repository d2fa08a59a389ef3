// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/scope/endoscope.h"

#include <cmath>

#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr double minAcross = 0.05;  // sine of the angle between view and vertical
constexpr double minDepth = 1e-6;   // m

}  // namespace

std::optional<PicturePoint> pointInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W) {
  const Vec3 p = camera.orientation.normalized().conjugate() * Vec3(p_W - camera.position);
  if (!(p.z() > minDepth)) return std::nullopt;
  const double half = 0.5 * frame.verticalFieldOfView;
  const double reach = p.z() * sine(half) / cosine(half);
  return PicturePoint{p.x() / reach, p.y() / reach};
}

bool isInPicture(const PictureFrame& frame, const CameraSample& camera, const Vec3& p_W, double share) {
  const std::optional<PicturePoint> p = pointInPicture(frame, camera, p_W);
  if (!p || std::abs(p->down) > 1.0) return false;
  const double radius = share * fieldRadius;
  return p->right * p->right + p->down * p->down <= radius * radius;
}

std::optional<double> horizonDeviation(const PictureFrame& frame, const CameraSample& camera) {
  const Vec3 up_W = frame.start.orientation.normalized() * Vec3(0.0, -1.0, 0.0);
  const Vec3 up = camera.orientation.normalized().conjugate() * up_W;
  if (!(up.x() * up.x() + up.y() * up.y() > minAcross * minAcross)) return std::nullopt;
  return arctangent2(-up.x(), -up.y());
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/measurement.h"

#include <cmath>

#include "sim/instruments/port.h"

namespace calot {

namespace {

/// Least norm of a quaternion that still says a direction. Samples are rounded to 2^-16 (roundedToGrid), so a
/// measurement's is 1 within 1e-4. Smaller would accept noise, larger refuses coarse devices. Assumed.
constexpr double minQuaternionNorm = 0.5;

}  // namespace

bool isMeasurement(const InstrumentSample& sample) {
  return sample.valid && sample.position.allFinite() && sample.orientation.coeffs().allFinite() &&
         std::isfinite(sample.jaw) && sample.orientation.coeffs().norm() > minQuaternionNorm;
}

bool isMeasurement(const CameraSample& sample) {
  const double norm = sample.orientation.coeffs().norm();
  return sample.position.allFinite() && std::isfinite(norm) && norm > minQuaternionNorm;
}

Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& tip) {
  return tip.cwiseMax(scene.workspace[0]).cwiseMin(scene.workspace[1]);
}

Vec3 axisOf(const Vec3& port, const Vec3& tip) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  return length > 1e-6 ? Vec3(reach / length) : Vec3(0.0, 0.0, -1.0);
}

Pose realPose(const SceneDescription& scene, std::size_t hand, const InstrumentSample& sample,
              const Vec3& previousTip) {
  const Vec3& port = scene.hands[hand].port;
  Quat orientation = sample.orientation;
  orientation.coeffs() /= orientation.coeffs().norm();
  return throughPort(port, clampedToWorkspace(scene, sample.position), orientation, axisOf(port, previousTip));
}

}  // namespace calot

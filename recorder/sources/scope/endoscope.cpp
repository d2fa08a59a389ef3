// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/scope/endoscope.h"

#include <algorithm>
#include <cmath>

#include "recorder/sources/scene_surfaces.h"
#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr double scopeSight = 0.5;       // m, that is searched for an organ
constexpr double usualDistance = 0.12;   // m, where it meets none
constexpr double longestDistance = 0.2;  // m
constexpr double minAngle = 1e-6;        // rad; below, an optic is straight

Quat aboutX(double angle) { return {cosine(0.5 * angle), sine(0.5 * angle), 0.0, 0.0}; }
Quat aboutY(double angle) { return {cosine(0.5 * angle), 0.0, sine(0.5 * angle), 0.0}; }
Quat aboutZ(double angle) { return {cosine(0.5 * angle), 0.0, 0.0, sine(0.5 * angle)}; }

/// Within half a turn each way.
double wrapped(double angle) {
  constexpr double turn = 2.0 * Endoscope::maxRotation;
  return angle - turn * std::floor(angle / turn + 0.5);
}

double distanceToFirstOrgan(const SceneDescription& scene) {
  const Vec3 view = scene.camera.orientation.normalized() * Vec3(0.0, 0.0, 1.0);
  const auto hit =
      SceneSurfaces(scene).firstHit(scene.camera.position, scene.camera.position + Vec3(scopeSight * view));
  return hit ? std::min(scopeSight * hit->parameter, longestDistance) : usualDistance;
}

/// Directions in the base's frame: where a shaft of that pan and tilt points.
struct Swing {
  double pan = 0.0, tilt = 0.0;
};
Swing swingOf(const Vec3& direction) {
  const double level = std::sqrt(direction.x() * direction.x() + direction.z() * direction.z());
  return {arctangent2(direction.x(), direction.z()), arctangent2(-direction.y(), level)};
}

}  // namespace

Endoscope::Endoscope(const SceneDescription& scene, double optic)
    : optic_(optic),
      frame_{scene.camera, scene.verticalFieldOfView},
      base_(scene.camera.orientation.normalized()),
      port_(scene.camera.position - Vec3(portDistance * (base_ * Vec3(0.0, 0.0, 1.0)))),
      workingDistance_(distanceToFirstOrgan(scene)) {
  start_.insertion = portDistance;
  if (optic_ > minAngle) {
    const Vec3 seen = scene.camera.position + Vec3(workingDistance_ * (base_ * Vec3(0.0, 0.0, 1.0)));
    start_ = aimedAt(seen, workingDistance_, start_);
  }
}

CameraSample Endoscope::pose(const ScopeJoints& joints) const {
  const Quat shaft = base_ * aboutY(joints.pan) * aboutX(joints.tilt);
  CameraSample camera;
  camera.position = port_ + Vec3(joints.insertion * (shaft * Vec3(0.0, 0.0, 1.0)));
  camera.orientation = optic_ > minAngle
                           ? shaft * aboutZ(joints.cable) * aboutX(-optic_) * aboutZ(joints.head - joints.cable)
                           : shaft * aboutZ(joints.head);
  camera.orientation.coeffs() /= camera.orientation.coeffs().norm();
  return camera;
}

ScopeJoints Endoscope::jointsOf(const CameraSample& camera) const {
  ScopeJoints joints = start_;
  const Vec3 reach = camera.position - port_;
  joints.insertion = reach.norm();
  const Swing swing = swingOf(base_.conjugate() * reach);
  joints.pan = swing.pan;
  joints.tilt = swing.tilt;
  const Quat shaft = base_ * aboutY(joints.pan) * aboutX(joints.tilt);
  const Quat rest = shaft.conjugate() * camera.orientation.normalized();
  joints.cable = 0.0;
  if (optic_ > minAngle) {
    const Vec3 view = rest * Vec3(0.0, 0.0, 1.0);
    joints.cable = arctangent2(-view.x(), view.y());
  }
  const Quat across = aboutX(optic_ > minAngle ? optic_ : 0.0) * aboutZ(-joints.cable) * rest;
  joints.head = wrapped(joints.cable + 2.0 * arctangent2(across.z(), across.w()));
  return withinLimits(joints);
}

ScopeJoints Endoscope::withinLimits(const ScopeJoints& joints) {
  ScopeJoints out;
  out.pan = std::clamp(joints.pan, -maxSwing, maxSwing);
  out.tilt = std::clamp(joints.tilt, -maxSwing, maxSwing);
  out.insertion = std::clamp(joints.insertion, minInsertion, maxInsertion);
  out.cable = std::clamp(joints.cable, -maxRotation, maxRotation);
  out.head = std::clamp(joints.head, -maxRotation, maxRotation);
  return out;
}

/// Port, lens and point are a triangle whose exterior angle at the lens is the optic's a: from the port the point is as
/// far as R^2 = L^2 + D^2 + 2 L D cos a, with the insertion L and the distance D from the lens.
ScopeJoints Endoscope::aimedAt(const Vec3& p_W, double distance, const ScopeJoints& present) const {
  const Vec3 p = base_.conjugate() * Vec3(p_W - port_);
  const double range = p.norm();
  const double s = sine(optic_), c = cosine(optic_);
  if (!(range > 1.5 * minInsertion)) return present;
  const double under = range * range - distance * distance * s * s;
  const double wanted = under > 0.0 ? std::sqrt(under) - distance * c : minInsertion;
  ScopeJoints joints;
  joints.insertion = std::clamp(wanted, minInsertion, std::min(maxInsertion, range - 0.5 * minInsertion));
  const double left = range * range - joints.insertion * joints.insertion * s * s;
  const double seen = std::sqrt(left) - joints.insertion * c;  // the distance that comes of it
  const double sineAtPort = seen * s / range;
  const double up = arctangent2(sineAtPort, std::sqrt(1.0 - sineAtPort * sineAtPort));
  const Swing swing = swingOf(p);
  joints.pan = swing.pan;
  joints.tilt = swing.tilt + up;
  return withinLimits(joints);
}

namespace {

void follow(double wish, double maxSpeed, double& at, double& speed) {
  constexpr double w = ScopeMotion::frequency;
  speed += tickLength * (w * w * (wish - at) - 2.0 * w * speed);
  speed = std::clamp(speed, -maxSpeed, maxSpeed);
  at += tickLength * speed;
}

}  // namespace

void ScopeMotion::advance(const ScopeJoints& wish) {
  const ScopeJoints to = Endoscope::withinLimits(wish);
  follow(to.pan, maxSwingSpeed, joints_.pan, speed_.pan);
  follow(to.tilt, maxSwingSpeed, joints_.tilt, speed_.tilt);
  follow(to.insertion, maxInsertSpeed, joints_.insertion, speed_.insertion);
  follow(to.cable, maxRotateSpeed, joints_.cable, speed_.cable);
  follow(to.head, maxRotateSpeed, joints_.head, speed_.head);
  joints_ = Endoscope::withinLimits(joints_);
}

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

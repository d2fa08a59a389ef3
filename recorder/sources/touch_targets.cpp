// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/touch_targets.h"

#include <cmath>

#include "recorder/sources/pointing.h"
#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr double facing = 0.34202014332566873;  // sine of 20 degrees
constexpr double skinMargin = 0.010;            // m
constexpr double lift = 0.001;                  // lines of sight end this far off the surface (m)
constexpr double approachClearance = 0.005;     // m
constexpr double pathSpacing = 0.002;           // m
constexpr double aspect = 16.0 / 9.0;

// Inside the picture, with `tangent` that of half the vertical field of view.
bool isInPicture(const SceneDescription& scene, const Vec3& p, double tangent) {
  const Vec3 c = scene.camera.orientation.conjugate() * (p - scene.camera.position);
  return c.z() > 0.01 && std::abs(c.y()) < c.z() * tangent && std::abs(c.x()) < c.z() * tangent * aspect;
}

bool isInWorkspace(const SceneDescription& scene, const Vec3& p) {
  return (p.array() > scene.workspace[0].array() + skinMargin).all() &&
         (p.array() < scene.workspace[1].array() - skinMargin).all();
}

}  // namespace

bool isFree(const SceneSurfaces& surfaces, const Vec3& a, const Vec3& b, double clearance) {
  if (surfaces.firstHit(a, b)) return false;
  const auto pieces = static_cast<int>(std::ceil((b - a).norm() / pathSpacing)) + 1;
  for (int i = 0; i <= pieces; ++i) {
    const Vec3 p = a + (static_cast<double>(i) / pieces) * (b - a);
    if (surfaces.signedDistance(p) < clearance) return false;
  }
  return true;
}

std::vector<TouchTarget> touchTargets(const SceneDescription& scene, const SceneSurfaces& surfaces, std::size_t hand,
                                      double pullBack) {
  const double half = 0.5 * scene.verticalFieldOfView;
  const double tangent = sine(half) / cosine(half);
  const Vec3& port = scene.hands[hand].port;
  const Vec3& eye = scene.camera.position;
  std::vector<TouchTarget> targets;
  for (std::size_t o = 0; o < surfaces.organs(); ++o) {
    const TriangleMesh& mesh = surfaces.mesh(o);
    for (int t = 0; t < mesh.triangles(); ++t) {
      const Vec3 area = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
      const double length = area.norm();
      if (!(length > 1e-12)) continue;
      TouchTarget target;
      target.organ = o;
      target.point = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      target.normal = area / length;
      const Vec3 toEye = eye - target.point;
      const Vec3 shaft = shaftDirection(port, target.point);
      if (target.normal.dot(toEye) < facing * toEye.norm() || target.normal.dot(shaft) > -facing) continue;
      target.approach = target.point - pullBack * shaft;
      if (!isInWorkspace(scene, target.point) || !isInWorkspace(scene, target.approach)) continue;
      if (!isInPicture(scene, target.point, tangent)) continue;
      if ((target.point - port).norm() < pullBack + skinMargin) continue;
      if (surfaces.signedDistance(target.approach) < approachClearance) continue;
      const Vec3 off = target.point + lift * target.normal;
      if (surfaces.firstHit(eye, off) || surfaces.firstHit(port, off)) continue;
      targets.push_back(target);
    }
  }
  return targets;
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/scene_surfaces.h"

#include <algorithm>

#include "sim/geometry/closest_point.h"

namespace calot::recorder {

namespace {

/// Far more than rounding moves a crossing (m).
constexpr double boxMargin = 1e-7;

Box boxOf(const TriangleMesh& mesh, int t) {
  Box box;
  for (int k = 0; k < 3; ++k) box.include(mesh.corner(t, k));
  return box;
}

/// May the segment from a to b meet the box?
bool meets(const Box& box, const Vec3& a, const Vec3& b) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double along = b[k] - a[k];
    if (along == 0.0) {
      if (a[k] < box.lower[k] - boxMargin || a[k] > box.upper[k] + boxMargin) return false;
      continue;
    }
    const double s = (box.lower[k] - boxMargin - a[k]) / along, t = (box.upper[k] + boxMargin - a[k]) / along;
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  // Parameters of a segment of decimetres; the margin of the boxes is far wider than their rounding.
  return enter <= leave;
}

}  // namespace

SceneSurfaces::SceneSurfaces(const SceneDescription& scene) {
  organs_.reserve(scene.organs.size());
  for (const OrganDescription& organ : scene.organs) {
    TriangleMesh mesh{organ.surface.vertex, organ.surface.triangle};
    bounds_.push_back(calot::bounds(mesh));
    organs_.emplace_back(std::move(mesh));
  }
}

double SceneSurfaces::signedDistance(const Vec3& p) const {
  double least = 1e300;
  for (const SurfaceDistance& organ : organs_) least = std::min(least, organ.signedDistance(p));
  return least;
}

std::optional<SceneSurfaces::Hit> SceneSurfaces::firstHit(const Vec3& a, const Vec3& b) const {
  std::optional<Hit> best;
  Box segment;
  segment.include(a);
  segment.include(b);
  for (std::size_t o = 0; o < organs_.size(); ++o) {
    if (!segment.overlaps(bounds_[o])) continue;
    const TriangleMesh& mesh = organs_[o].mesh();
    // Triangles that are crossed at the same parameter are crossed at the same point: their order does not matter.
    const auto near = [&](const Box& box) { return meets(box, a, b); };
    organs_[o].forEachNear(near, [&](int t) {
      if (!segment.overlaps(boxOf(mesh, t))) return;
      const SegmentTriangle r = closestSegmentTriangle(a, b, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      if (r.crosses && (!best || r.parameter < best->parameter)) best = Hit{o, r.parameter, r.onTriangle};
    });
  }
  return best;
}

}  // namespace calot::recorder

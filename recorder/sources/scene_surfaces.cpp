// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/scene_surfaces.h"

#include <algorithm>

#include "sim/geometry/closest_point.h"

namespace calot::recorder {

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
    for (int t = 0; t < mesh.triangles(); ++t) {
      Box box;
      for (int k = 0; k < 3; ++k) box.include(mesh.corner(t, k));
      if (!segment.overlaps(box)) continue;
      const SegmentTriangle r = closestSegmentTriangle(a, b, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      if (r.crosses && (!best || r.parameter < best->parameter)) best = Hit{o, r.parameter, r.onTriangle};
    }
  }
  return best;
}

}  // namespace calot::recorder

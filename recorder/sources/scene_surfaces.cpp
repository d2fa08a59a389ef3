// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/scene_surfaces.h"

#include <algorithm>

#include "sim/geometry/closest_point.h"

namespace calot::recorder {

namespace {

constexpr int leafTriangles = 8;
/// Far more than rounding moves a crossing (m).
constexpr double boxMargin = 1e-7;

Box boxOf(const TriangleMesh& mesh, int t) {
  Box box;
  for (int k = 0; k < 3; ++k) box.include(mesh.corner(t, k));
  return box;
}

}  // namespace

SegmentSearch::SegmentSearch(const TriangleMesh& mesh) {
  for (int t = 0; t < mesh.triangles(); ++t) order_.push_back(t);
  if (!order_.empty()) build(mesh, 0, mesh.triangles());
}

void SegmentSearch::build(const TriangleMesh& mesh, int first, int last) {
  const std::size_t at = node_.size();
  node_.emplace_back();
  Box box;
  for (int i = first; i < last; ++i) {
    const int t = order_[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) box.include(mesh.corner(t, k));
  }
  int axis = 0;
  (box.upper - box.lower).maxCoeff(&axis);
  box.lower -= Vec3::Constant(boxMargin);
  box.upper += Vec3::Constant(boxMargin);
  node_[at].box = box;
  node_[at].first = first;
  node_[at].count = last - first;
  if (last - first <= leafTriangles) return;
  const int middle = first + (last - first) / 2;
  const auto place = [&](int t) { return mesh.corner(t, 0)[axis] + mesh.corner(t, 1)[axis] + mesh.corner(t, 2)[axis]; };
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int s, int t) { return place(s) < place(t); });
  build(mesh, first, middle);
  node_[at].right = static_cast<int>(node_.size());
  build(mesh, middle, last);
}

bool SegmentSearch::meets(const Box& box, const Vec3& a, const Vec3& b) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double along = b[k] - a[k];
    if (along == 0.0) {
      if (a[k] < box.lower[k] || a[k] > box.upper[k]) return false;
      continue;
    }
    const double s = (box.lower[k] - a[k]) / along, t = (box.upper[k] - a[k]) / along;
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  // Parameters of a segment of decimetres; the margin of the boxes is far wider than their rounding.
  return enter <= leave;
}

SceneSurfaces::SceneSurfaces(const SceneDescription& scene) {
  organs_.reserve(scene.organs.size());
  for (const OrganDescription& organ : scene.organs) {
    TriangleMesh mesh{organ.surface.vertex, organ.surface.triangle};
    bounds_.push_back(calot::bounds(mesh));
    search_.emplace_back(mesh);
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
    search_[o].forEachNear(a, b, [&](int t) {
      if (!segment.overlaps(boxOf(mesh, t))) return;
      const SegmentTriangle r = closestSegmentTriangle(a, b, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      if (r.crosses && (!best || r.parameter < best->parameter)) best = Hit{o, r.parameter, r.onTriangle};
    });
  }
  return best;
}

}  // namespace calot::recorder

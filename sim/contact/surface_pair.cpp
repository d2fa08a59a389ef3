// SPDX-License-Identifier: GPL-3.0-or-later
// What is known at rest of two surfaces.
#include <algorithm>
#include <cmath>

#include "sim/contact/surface_search.h"
#include "sim/contact/surface_surface.h"
#include "sim/geometry/closest_point.h"

namespace calot {

SurfacePair::SurfacePair(const ContactSurface& vertices, std::span<const Vec3> vertexRest,
                         const ContactSurface& triangles, std::span<const Vec3> triangleRest)
    : restA_(vertexRest.begin(), vertexRest.end()),
      restB_(triangleRest.begin(), triangleRest.end()),
      triangle_(triangles.triangles()) {
  measureRest(vertices, triangles);
}

SurfacePair::SurfacePair(const ContactSurface& surface, std::span<const Vec3> rest)
    : self_(true), restA_(rest.begin(), rest.end()), restB_(rest.begin(), rest.end()), triangle_(surface.triangles()) {
  Candidates candidates;
  std::vector<std::vector<std::uint32_t>> lists(rest.size());
  std::vector<double> radius(rest.size(), 0.0);
  for (std::uint32_t p = 0; p < surface.patches().size(); ++p) {
    double widest = 0.0;
    for (const int node : surface.patchNodes(p)) {
      const auto v = static_cast<std::size_t>(node);
      const std::span<const int> neighbours = surface.neighbours(node);
      for (const int n : neighbours) radius[v] += (rest[static_cast<std::size_t>(n)] - rest[v]).norm();
      radius[v] *= selfMultiple / static_cast<double>(neighbours.size());
      widest = std::max(widest, radius[v]);
    }
    candidates.gather(surface, rest, allPatches(surface), boundsOf(surface, rest, p, widest));
    for (const int node : surface.patchNodes(p)) {
      const auto v = static_cast<std::size_t>(node);
      double limit = radius[v] * radius[v];
      candidates.forEachNear(rest[v], limit,
                             [&](std::size_t i, double) { lists[v].push_back(static_cast<std::uint32_t>(i)); });
      std::sort(lists[v].begin(), lists[v].end());
    }
  }
  excludedStart_.push_back(0);
  for (const std::vector<std::uint32_t>& list : lists) {
    excluded_.insert(excluded_.end(), list.begin(), list.end());
    excludedStart_.push_back(excluded_.size());
  }
  measureRest(surface, surface);
}

bool SurfacePair::excluded(int vertex, std::size_t triangle) const {
  if (!self_) return false;
  const auto v = static_cast<std::size_t>(vertex);
  const auto first = excluded_.begin() + static_cast<std::ptrdiff_t>(excludedStart_[v]);
  const auto last = excluded_.begin() + static_cast<std::ptrdiff_t>(excludedStart_[v + 1]);
  return std::binary_search(first, last, static_cast<std::uint32_t>(triangle)) || wasBehind(vertex, triangle);
}

bool SurfacePair::wasBehind(int vertex, std::size_t triangle) const {
  const Index3& t = triangle_[triangle];
  const Vec3& p = restA_[static_cast<std::size_t>(vertex)];
  const Vec3& a = restB_[static_cast<std::size_t>(t[0])];
  const Vec3& b = restB_[static_cast<std::size_t>(t[1])];
  const Vec3& c = restB_[static_cast<std::size_t>(t[2])];
  const Vec3 normal = (b - a).cross(c - a);
  if (!((p - a).dot(normal) < 0.0)) return false;
  const PointTriangle point = closestOnTriangle(p, a, b, c);
  if (point.squaredDistance > thickest * thickest) return false;
  // Behind in earnest, not beside on the same bent side: more than 30 degrees below the face's plane.
  return (p - point.point).dot(normal) < -0.5 * std::sqrt(point.squaredDistance * normal.squaredNorm());
}

void SurfacePair::measureRest(const ContactSurface& a, const ContactSurface& b) {
  // Between two surfaces an overlap counts however deep it is; of a surface with itself only what would be seen.
  constexpr double far = 1e3;
  offset_.assign(restA_.size(), 0.0);
  vertexDistance_.assign(restA_.size(), known);
  patchesB_ = b.patches().size();
  patchDistance_.assign(a.patches().size() * patchesB_, known);
  SearchRoom wholeRoom;
  SurfaceSearch whole(*this, a, restA_, b, restB_, wholeRoom);
  whole.gather(Box{Vec3::Constant(-1e300), Vec3::Constant(1e300)});
  SearchRoom room;
  SurfaceSearch search(*this, a, restA_, b, restB_, room);
  for (std::uint32_t p = 0; p < a.patches().size(); ++p) {
    double depth = deepestOverlap;
    const std::span<double> row{patchDistance_.data() + p * patchesB_, patchesB_};
    const Box box = boundsOf(a, restA_, p, known);
    search.gather(box);
    for (const int v : a.patchNodes(p)) {
      const auto i = static_cast<std::size_t>(v);
      Near near = search.nearest(v, restA_[i], self_ ? deepestOverlap : known);
      if (!near.found && !self_) near = whole.nearest(v, restA_[i], far);
      if (near.found) offset_[i] = std::min(0.0, near.distance);
      depth = std::max(depth, deepestOverlap - offset_[i]);
      double limit = known * known;
      room.candidates.forEachNear(restA_[i], limit, [&](std::size_t t, double squared) {
        double& least = row[b.patchOf(t)];
        const double distance = std::sqrt(squared);
        if ((distance >= least && distance >= vertexDistance_[i]) || excluded(v, t)) return;
        least = std::min(least, distance);
        vertexDistance_[i] = std::min(vertexDistance_[i], distance);
      });
    }
    depth_.push_back(depth);
    leastDistance_.push_back(*std::min_element(row.begin(), row.end()));
  }
}

}  // namespace calot

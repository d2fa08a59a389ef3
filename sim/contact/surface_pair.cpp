// SPDX-License-Identifier: GPL-3.0-or-later
// What the reference configuration says about two surfaces.
#include <algorithm>
#include <cmath>

#include "sim/contact/surface_search.h"
#include "sim/contact/surface_surface.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/bounds.h"

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
  for (const Index3& t : triangle_) {
    const Vec3& a = rest[static_cast<std::size_t>(t[0])];
    normal_.push_back((rest[static_cast<std::size_t>(t[1])] - a).cross(Vec3(rest[static_cast<std::size_t>(t[2])] - a)));
  }
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
  const std::span<const std::uint32_t> near = listed(v);
  if (std::binary_search(near.begin(), near.end(), static_cast<std::uint32_t>(triangle))) return true;
  const Index3& t = triangle_[triangle];
  const auto corner = [&](int k) { return restB_[static_cast<std::size_t>(t[k])]; };
  return liesBehind(v, triangle, closestOnTriangle(restA_[v], corner(0), corner(1), corner(2)).squaredDistance);
}

std::uint32_t SurfacePair::notExcluded(int vertex, std::size_t first, std::size_t count,
                                       const TriangleLanes& rest) const {
  std::uint32_t lanes = (1U << count) - 1U;
  if (!self_) return lanes;
  const auto v = static_cast<std::size_t>(vertex);
  LaneValues squared;
  pointTriangleDistances(rest, restA_[v], squared);
  for (std::size_t l = 0; l < count; ++l) lanes &= ~((liesBehind(v, first + l, squared[l]) ? 1U : 0U) << l);
  const std::span<const std::uint32_t> near = listed(v);
  auto next = std::lower_bound(near.begin(), near.end(), static_cast<std::uint32_t>(first));
  for (; next != near.end() && *next < first + count; ++next) lanes &= ~(1U << (*next - first));
  return lanes;
}

/// @param squared distance at rest (m^2)
bool SurfacePair::liesBehind(std::size_t vertex, std::size_t triangle, double squared) const {
  if (squared > maxPartThickness * maxPartThickness) return false;
  const Vec3& normal = normal_[triangle];
  const double height = (restA_[vertex] - restB_[static_cast<std::size_t>(triangle_[triangle][0])]).dot(normal);
  // More than 30 degrees below the face's plane: behind it, not beside it on the same curved side.
  return height < 0.0 && height < -0.5 * std::sqrt(squared * normal.squaredNorm());
}

void SurfacePair::measureRest(const ContactSurface& a, const ContactSurface& b) {
  // Between two surfaces, an overlap of any depth counts; within one surface, only one that detection would see.
  constexpr double far = 1e3;
  offset_.assign(restA_.size(), 0.0);
  vertexDistance_.assign(restA_.size(), known);
  patchesB_ = b.patches().size();
  patchDistance_.assign(a.patches().size() * patchesB_, known);
  SearchScratch wholeScratch;
  SurfaceSearch whole(*this, a, restA_, b, restB_, wholeScratch);
  whole.gather(Box{Vec3::Constant(-1e300), Vec3::Constant(1e300)});
  SearchScratch scratch;
  SurfaceSearch search(*this, a, restA_, b, restB_, scratch);
  for (std::uint32_t p = 0; p < a.patches().size(); ++p) {
    double depth = maxOverlap;
    const std::span<double> row{patchDistance_.data() + p * patchesB_, patchesB_};
    const Box box = boundsOf(a, restA_, p, known);
    search.gather(box);
    for (const int v : a.patchNodes(p)) {
      const auto i = static_cast<std::size_t>(v);
      Near near = search.nearest(v, restA_[i], self_ ? maxOverlap : known);
      if (!near.found && !self_) near = whole.nearest(v, restA_[i], far);
      if (near.found) offset_[i] = notPositive(near.distance);
      depth = std::max(depth, maxOverlap - offset_[i]);
      double limit = known * known;
      scratch.candidates.forEachNear(restA_[i], limit, [&](std::size_t t, double squared) {
        double& minimum = row[b.patchOf(t)];
        const double distance = std::sqrt(squared);
        if ((distance >= minimum && distance >= vertexDistance_[i]) || excluded(v, t)) return;
        minimum = std::min(minimum, distance);
        vertexDistance_[i] = std::min(vertexDistance_[i], distance);
      });
    }
    depth_.push_back(depth);
    minDistance_.push_back(*std::min_element(row.begin(), row.end()));
  }
}

}  // namespace calot

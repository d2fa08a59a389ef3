// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/contact/surface_normal.h"
#include "sim/math/bounds.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr double noDirection = 1e-9;  // m: nearer than this, the direction of the distance is noise

}  // namespace

void Candidates::gather(const ContactSurface& surface, std::span<const Vec3> position,
                        std::span<const std::uint32_t> patches, const Box& box) {
  triangle_.clear();
  std::array<std::uint32_t, ContactSurface::maxPatchTriangles> near{};
  for (const std::uint32_t p : patches) {
    const std::size_t count = trianglesInBox(surface, position, p, box, near);
    triangle_.insert(triangle_.end(), near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
  }
  group_.resize(laneGroups(triangle_.size()));
  bounds_.resize(group_.size());
  whole_.resize(group_.size());
  for (std::size_t g = 0; g < group_.size(); ++g) {
    gatherTriangles(surface, position, lanesOf(g), group_[g]);
    boundsOf(group_[g], bounds_[g], whole_[g]);
  }
}

void Candidates::boundsOf(const TriangleLanes& group, BoundsLanes& bounds, Box& whole) {
  boxesOf(group, bounds);
  whole = Box{};
  for (int a = 0; a < 3; ++a) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      whole.lower[a] = std::min(whole.lower[a], bounds.lower[a][l]);
      whole.upper[a] = std::max(whole.upper[a], bounds.upper[a][l]);
    }
  }
}

/// boxDistances() for the box of a whole group: at most that of any of its triangles, since rounding is monotonic.
double Candidates::boxDistance(const Box& box, const Vec3& p) {
  double squared = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double d = notNegative(std::max(box.lower[a] - p[a], p[a] - box.upper[a]));
    squared += d * d * (1.0 - 1e-12);
  }
  return squared;
}

bool Candidates::anyWithin(const LaneValues& squared, double best) {
  double minimum = squared[0];
  for (std::size_t l = 1; l < laneCount; ++l) minimum = std::min(minimum, squared[l]);
  return minimum <= best;
}

Displacement displacementOf(std::span<const int> nodes, std::span<const Vec3> position, std::span<const Vec3> rest) {
  Displacement d;
  d.spread = 0.0;
  if (nodes.empty()) return d;
  for (const int n : nodes) d.mean += position[static_cast<std::size_t>(n)] - rest[static_cast<std::size_t>(n)];
  d.mean /= static_cast<double>(nodes.size());
  for (const int n : nodes) {
    const auto i = static_cast<std::size_t>(n);
    d.spread = std::max(d.spread, (position[i] - rest[i] - d.mean).squaredNorm());
  }
  d.spread = std::sqrt(d.spread) + 1e-9;  // rounding
  return d;
}

Box boundsOf(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch, double margin) {
  Box box;
  for (const int v : surface.patchNodes(patch)) box.include(position[static_cast<std::size_t>(v)]);
  box.grow(margin);
  return box;
}

std::vector<std::uint32_t> allPatches(const ContactSurface& surface) {
  std::vector<std::uint32_t> all(surface.patches().size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

SurfaceSearch::SurfaceSearch(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                             const ContactSurface& b, std::span<const Vec3> positionB, SearchScratch& scratch)
    : pair_(pair), a_(a), positionA_(positionA), b_(b), positionB_(positionB), scratch_(scratch) {
  scratch_.displacement.assign(b.patches().size(), Displacement{});
}

bool SurfaceSearch::selectPatch(std::uint32_t patch, std::span<const std::uint32_t> near, double reach) {
  const Displacement own = displacementOf(a_.patchNodes(patch), positionA_, pair_.restA_);
  patch_ = patch;
  limit_ = pair_.search(patch, reach);
  const bool clear = pair_.depth_[patch] == maxOverlap;  // at rest, no vertex was inside
  bool any = false;
  scratch_.kept.clear();
  near_ = near;
  for (const std::uint32_t p : near) {
    Displacement& other = scratch_.displacement[p];
    if (other.spread < 0.0) other = displacementOf(b_.patchCorners(p), positionB_, pair_.restB_);
    const double minimum = pair_.patchDistance_[patch * pair_.patchesB_ + p] -
                           ((own.mean - other.mean).norm() + own.spread + other.spread);
    any = any || !clear || minimum <= reach;
    if (minimum <= limit_) scratch_.kept.push_back(p);
  }
  return any && !scratch_.kept.empty();
}

void SurfaceSearch::gather() {
  scratch_.candidates.gather(b_, positionB_, scratch_.kept, boundsOf(a_, positionA_, patch_, limit_));
  last_ = 0;
}

void SurfaceSearch::gather(const Box& box) {
  scratch_.candidates.gather(b_, positionB_, allPatches(b_), box);
  last_ = 0;
}

bool SurfaceSearch::surelyFar(std::size_t vertex, double reach) const {
  if (pair_.offset_[vertex] < 0.0) return false;
  const Vec3 own = positionA_[vertex] - pair_.restA_[vertex];
  const double minimum = pair_.vertexDistance_[vertex] - reach;
  for (const std::uint32_t p : near_) {
    const Displacement& d = scratch_.displacement[p];
    const double free = minimum - d.spread;
    if (!(free > 0.0) || (own - d.mean).squaredNorm() >= free * free) return false;
  }
  return true;
}

double SurfaceSearch::limitOf(std::size_t vertex, double reach) const {
  return std::max(reach, maxOverlap - pair_.offset_[vertex]);
}

Near SurfaceSearch::nearest(int vertex, const Vec3& p, double limit) {
  Near near;
  double best = limit * limit;
  const auto visit = [&](std::size_t i, double squared) {
    if (near.found && squared == best && i > near.triangle) return;
    const Index3& t = b_.triangles()[i];
    const PointTriangle point = closestOnTriangle(p, at(t[0]), at(t[1]), at(t[2]));
    if (pair_.self()) {
      if (!isLocalMinimum(b_, positionB_, i, point.feature, p - point.point)) return;
      if (pair_.excluded(vertex, i)) return;
    }
    near = Near{true, i, point, Vec3::Zero(), 0.0};
    best = squared;
  };
  last_ = scratch_.candidates.forEachNear(p, best, visit, last_);
  if (near.found) measure(p, near);
  return near;
}

void SurfaceSearch::offer(const Vec3& p, std::size_t triangle, Near& near, double& best) const {
  const Index3& t = b_.triangles()[triangle];
  const PointTriangle point = closestOnTriangle(p, at(t[0]), at(t[1]), at(t[2]));
  const double squared = point.squaredDistance;
  if (!(squared <= best) || (near.found && squared == best && triangle > near.triangle)) return;
  if (pair_.self() && !isLocalMinimum(b_, positionB_, triangle, point.feature, p - point.point)) return;
  near = Near{true, triangle, point, Vec3::Zero(), 0.0};
  best = squared;
}

void SurfaceSearch::measure(const Vec3& p, Near& near) const {
  const Vec3 outward = pseudonormal(b_, positionB_, near.triangle, near.point.feature);
  const Vec3 away = p - near.point.point;
  const double distance = std::sqrt(near.point.squaredDistance);
  const bool inside = away.dot(outward) < 0.0;
  near.distance = inside ? -distance : distance;
  if (distance > noDirection) {
    near.normal = inside ? Vec3(-away / distance) : Vec3(away / distance);
  } else {
    const double length = outward.norm();
    near.normal = length > 1e-6 ? Vec3(outward / length) : faceNormal(b_, positionB_, near.triangle);
  }
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

void measureDisplacement(const ContactSurface& surface, std::span<const Vec3> position, std::span<const Vec3> rest,
                         SurfaceDisplacement& out) {
  out.whole = displacementOf(surface.nodes(), position, rest);
  out.patch.resize(surface.patches().size());
  for (std::uint32_t p = 0; p < out.patch.size(); ++p) {
    out.patch[p] = displacementOf(surface.patchNodes(p), position, rest);
  }
}

void patchesInPlay(const SurfacePair& pair, const SurfaceDisplacement& a, const SurfaceDisplacement& b, double reach,
                   std::vector<std::uint32_t>& out) {
  out.clear();
  for (std::uint32_t p = 0; p < a.patch.size(); ++p) {
    const Displacement& own = a.patch[p];
    const double free = pair.minDistance_[p] - ((own.mean - b.whole.mean).norm() + own.spread + b.whole.spread);
    if (pair.depth_[p] > maxOverlap || free <= reach) out.push_back(p);
  }
}

void surfaceContacts(const SurfacePair& pair, const ContactSurface& a, std::span<const Vec3> positionA,
                     const ContactSurface& b, std::span<const Vec3> positionB, std::span<const BroadPhase::Pair> pairs,
                     double reach, std::vector<VertexContact>& out, NearTriangles* memory) {
  if (pairs.empty()) return;
  SearchScratch own;
  SearchScratch& scratch = memory != nullptr ? memory->scratch() : own;
  SurfaceSearch search(pair, a, positionA, b, positionB, scratch);
  if (memory != nullptr) memory->begin(search);
  for (std::size_t first = 0; first < pairs.size();) {
    const std::uint32_t query = pairs[first].query;
    scratch.near.clear();
    for (; first < pairs.size() && pairs[first].query == query; ++first) scratch.near.push_back(pairs[first].leaf);
    if (!search.selectPatch(query, scratch.near, reach)) continue;
    const std::span<const int> node = a.patchNodes(query);
    scratch.open.clear();
    for (std::size_t k = 0; k < node.size(); ++k) {
      if (!search.surelyFar(static_cast<std::size_t>(node[k]), reach)) scratch.open.push_back(k);
    }
    if (scratch.open.empty()) continue;
    if (memory != nullptr) {
      memory->updateLists(search, query, scratch.near, reach);
    } else {
      search.gather();
    }
    const std::size_t start = out.size();
    for (const std::size_t k : scratch.open) {
      const int v = node[k];
      const auto i = static_cast<std::size_t>(v);
      const double offset = pair.restOffset()[i];
      const Near near = memory != nullptr ? memory->nearest(search, k, reach)
                                          : search.nearest(v, positionA[i], search.limitOf(i, reach));
      if (!near.found) continue;
      const double gap = near.distance - offset;
      if (!(gap < reach) || gap < -maxOverlap || !(near.normal.squaredNorm() > 0.5)) continue;
      const Index3& t = b.triangles()[near.triangle];
      const std::uint64_t key = (static_cast<std::uint64_t>(query) << 20U) | b.patchOf(near.triangle);
      out.push_back({v, {t[0], t[1], t[2]}, near.point.barycentric, near.normal, gap, key});
    }
    const auto from = out.begin() + static_cast<std::ptrdiff_t>(start);
    std::sort(from, out.end(), [](const VertexContact& x, const VertexContact& y) {
      if (x.key != y.key) return x.key < y.key;
      return x.gap != y.gap ? x.gap < y.gap : x.vertex < y.vertex;
    });
    out.erase(
        std::unique(from, out.end(), [](const VertexContact& x, const VertexContact& y) { return x.key == y.key; }),
        out.end());
  }
}

// Facts about two surfaces in the reference configuration.

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

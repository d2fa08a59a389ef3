// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "sim/contact/broad_phase.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/math/elementary.h"
#include "sim/math/vectors.h"

namespace calot {

namespace {

/// Sorts items along the longest side of the bounds of their positions.
void sortAlong(std::vector<std::pair<Vec3, Index3>>& items, std::size_t first, std::size_t last) {
  Box box;
  for (std::size_t i = first; i < last; ++i) box.include(items[i].first);
  const Vec3 size = box.upper - box.lower;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : (size[1] >= size[2] ? 1 : 2);
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(first), items.begin() + static_cast<std::ptrdiff_t>(last),
            [axis](const auto& a, const auto& b) {
              if (a.first[axis] != b.first[axis]) return a.first[axis] < b.first[axis];
              return std::lexicographical_compare(a.second.data(), a.second.data() + 3, b.second.data(),
                                                  b.second.data() + 3);
            });
}

/// Orders triangles within a patch so that those of one lane group are close together.
void group(std::vector<std::pair<Vec3, Index3>>& items, std::size_t first, std::size_t last) {
  const std::size_t groups = laneGroups(last - first);
  if (groups <= 1) return;
  sortAlong(items, first, last);
  const std::size_t middle = first + groups / 2 * laneCount;
  group(items, first, middle);
  group(items, middle, last);
}

void halve(std::vector<std::pair<Vec3, Index3>>& items, std::size_t first, std::size_t last,
           std::vector<ContactSurface::Patch>& patches) {
  if (last - first <= ContactSurface::maxPatchTriangles) {
    patches.push_back({first, last});
    group(items, first, last);
    return;
  }
  sortAlong(items, first, last);
  const std::size_t middle = first + (last - first) / 2;
  halve(items, first, middle, patches);
  halve(items, middle, last, patches);
}

}  // namespace

ContactSurface::ContactSurface(std::span<const Vec3> rest, std::span<const Index3> triangles) {
  std::vector<std::pair<Vec3, Index3>> items;
  items.reserve(triangles.size());
  for (const Index3& t : triangles) {
    const Vec3 centre = (rest[static_cast<std::size_t>(t[0])] + rest[static_cast<std::size_t>(t[1])] +
                         rest[static_cast<std::size_t>(t[2])]) /
                        3.0;
    items.emplace_back(centre, t);
  }
  if (!items.empty()) halve(items, 0, items.size(), patch_);
  triangle_.reserve(items.size());
  for (const auto& item : items) triangle_.push_back(item.second);

  struct Side {
    int third;
    int triangle;
  };
  std::map<std::pair<int, int>, Side> opposite;  // by directed edge
  std::vector<std::vector<int>> neighbours(rest.size());
  std::vector<std::vector<std::uint32_t>> around(rest.size());
  for (std::size_t i = 0; i < triangle_.size(); ++i) {
    const Index3& t = triangle_[i];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      opposite[{a, b}] = {t[(k + 2) % 3], static_cast<int>(i)};
      around[static_cast<std::size_t>(a)].push_back(static_cast<std::uint32_t>(i));
      neighbours[static_cast<std::size_t>(a)].push_back(b);
      neighbours[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  for (const Index3& t : triangle_) {
    Index3 o;
    Index3 beyond;
    for (int k = 0; k < 3; ++k) {
      const auto found = opposite.find({t[(k + 1) % 3], t[k]});
      o[k] = found == opposite.end() ? -1 : found->second.third;
      beyond[k] = found == opposite.end() ? -1 : found->second.triangle;
    }
    opposite_.push_back(o);
    beyond_.push_back(beyond);
  }
  aroundStart_.push_back(0);
  for (const std::vector<std::uint32_t>& list : around) {
    around_.insert(around_.end(), list.begin(), list.end());
    aroundStart_.push_back(around_.size());
  }
  patchOf_.resize(triangle_.size());
  patchNodeStart_.push_back(0);
  patchCornerStart_.push_back(0);
  std::vector<bool> taken(rest.size(), false);
  for (std::size_t p = 0; p < patch_.size(); ++p) {
    const auto start = static_cast<std::ptrdiff_t>(patchNode_.size());
    const auto cornerStart = static_cast<std::ptrdiff_t>(patchCorner_.size());
    for (std::size_t i = patch_[p].first; i < patch_[p].last; ++i) {
      patchOf_[i] = static_cast<std::uint32_t>(p);
      for (int k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(triangle_[i][k]);
        patchCorner_.push_back(triangle_[i][k]);
        if (!taken[n]) patchNode_.push_back(triangle_[i][k]);
        taken[n] = true;
      }
    }
    std::sort(patchNode_.begin() + start, patchNode_.end());
    patchNodeStart_.push_back(patchNode_.size());
    std::sort(patchCorner_.begin() + cornerStart, patchCorner_.end());
    patchCorner_.erase(std::unique(patchCorner_.begin() + cornerStart, patchCorner_.end()), patchCorner_.end());
    patchCornerStart_.push_back(patchCorner_.size());
  }
  neighbourStart_.push_back(0);
  for (std::size_t n = 0; n < neighbours.size(); ++n) {
    std::vector<int>& list = neighbours[n];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    neighbour_.insert(neighbour_.end(), list.begin(), list.end());
    neighbourStart_.push_back(neighbour_.size());
    if (!list.empty()) node_.push_back(static_cast<int>(n));
  }
}

int ContactSurface::oppositeNow(std::size_t triangle, int k) const {
  const Index3& mine = triangle_[triangle];
  const Index3& other = triangle_[topology_->across(triangle, k)];
  for (int j = 0; j < 3; ++j) {
    if (other[j] != mine[k] && other[j] != mine[(k + 1) % 3]) return other[j];
  }
  return -1;
}

std::span<const int> ContactSurface::neighbours(int node, Fan& fan) const {
  if (topology_ == nullptr) return neighbours(node);
  std::size_t count = 0;
  for (const std::uint32_t t : trianglesAround(node, fan)) {
    for (int k = 0; k < 3; ++k) {
      if (triangle_[t][k] != node) fan.node[count++] = triangle_[t][k];
    }
  }
  return {fan.node.data(), count};
}

void patchBounds(const ContactSurface& surface, std::span<const Vec3> position, double margin, std::vector<Box>& out) {
  out.resize(surface.patches().size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    Box box;
    for (const int n : surface.patchCorners(static_cast<std::uint32_t>(p))) {
      box.include(position[static_cast<std::size_t>(n)]);
    }
    box.grow(margin);
    out[p] = outwardBox(box);
  }
}

void changedBounds(std::span<const Box> before, std::span<const Box> after, std::vector<std::uint32_t>& changed) {
  changed.clear();
  for (std::size_t p = 0; p < after.size(); ++p) {
    if ((before[p].lower.array() != after[p].lower.array()).any() ||
        (before[p].upper.array() != after[p].upper.array()).any()) {
      changed.push_back(static_cast<std::uint32_t>(p));
    }
  }
}

namespace {

constexpr double minArea = 1e-18;  // m^2, twice the area
constexpr double slack = 1e-9;     // m^2: smaller differences count as equal distances

}  // namespace

Vec3 faceNormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle) {
  const Index3& t = surface.triangles()[triangle];
  const Vec3& a = position[static_cast<std::size_t>(t[0])];
  const Vec3 area = (position[static_cast<std::size_t>(t[1])] - a).cross(position[static_cast<std::size_t>(t[2])] - a);
  const double length = area.norm();
  if (!(length > minArea)) return Vec3::Zero();
  return area / length;
}

Vec3 pseudonormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                  TriangleFeature feature) {
  const auto f = static_cast<int>(feature);
  if (f == 0) return faceNormal(surface, position, triangle);
  if (f <= 3) {
    Vec3 sum = faceNormal(surface, position, triangle);
    const int beyond = surface.neighbourTriangle(triangle, f - 1);
    if (beyond >= 0) sum += faceNormal(surface, position, static_cast<std::size_t>(beyond));
    return sum;
  }
  const int node = surface.triangles()[triangle][f - 4];
  const Vec3& p = position[static_cast<std::size_t>(node)];
  Vec3 sum = Vec3::Zero();
  ContactSurface::Fan fan;
  for (const std::uint32_t i : surface.trianglesAround(node, fan)) {
    const Index3& t = surface.triangles()[i];
    const int k = t[0] == node ? 0 : (t[1] == node ? 1 : 2);
    const Vec3 u = position[static_cast<std::size_t>(t[(k + 1) % 3])] - p;
    const Vec3 v = position[static_cast<std::size_t>(t[(k + 2) % 3])] - p;
    const double lengths = std::sqrt(u.squaredNorm() * v.squaredNorm());
    if (!(lengths > minArea)) continue;
    sum += arccosine(u.dot(v) / lengths) * faceNormal(surface, position, i);
  }
  return sum;
}

bool isLocalMinimum(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                    TriangleFeature feature, const Vec3& away) {
  const auto f = static_cast<int>(feature);
  if (f == 0) return true;
  const Index3& t = surface.triangles()[triangle];
  const auto at = [&](int node) -> const Vec3& { return position[static_cast<std::size_t>(node)]; };
  if (f <= 3) {
    const int k = f - 1;
    const int third = surface.opposite(triangle, k);
    if (third < 0) return true;
    const Vec3 edge = at(t[(k + 1) % 3]) - at(t[k]);
    Vec3 inward = at(third) - at(t[k]);
    inward -= edge * (inward.dot(edge) / edge.squaredNorm());
    return away.dot(inward) <= slack;
  }
  ContactSurface::Fan fan;
  for (const int n : surface.neighbours(t[f - 4], fan)) {
    if (away.dot(at(n) - at(t[f - 4])) > slack) return false;
  }
  return true;
}

std::uint64_t featureKey(const ContactSurface& surface, std::size_t triangle, TriangleFeature feature) {
  const Index3& t = surface.triangles()[triangle];
  const auto f = static_cast<int>(feature);
  // A triangle's index within an organ is fixed in Model.
  if (f == 0) return (std::uint64_t{1} << 50U) | surface.name(triangle);
  if (f <= 3) {
    const auto u = static_cast<std::uint64_t>(std::min(t[f - 1], t[f % 3]));
    const auto v = static_cast<std::uint64_t>(std::max(t[f - 1], t[f % 3]));
    return (std::uint64_t{2} << 50U) | (u << 25U) | v;
  }
  return (std::uint64_t{3} << 50U) | static_cast<std::uint64_t>(t[f - 4]);
}

NearestPoint nearestPoint(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p, double limit) {
  NearestPoint nearest;
  double best = limit * limit;
  Box box;
  box.include(p);
  box.grow(limit);
  std::array<std::uint32_t, ContactSurface::maxPatchTriangles> near;
  for (const std::uint32_t patch : patches) {
    const std::size_t count = trianglesInBox(surface, position, patch, box, near);
    for (std::size_t first = 0; first < count; first += laneCount) {
      const std::size_t lanes = std::min<std::size_t>(laneCount, count - first);
      TriangleLanes group;
      gatherTriangles(surface, position, {near.data() + first, lanes}, group);
      LaneValues squared;
      pointTriangleDistances(group, p, squared);
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::size_t i = near[first + l];
        if (squared[l] > best || (nearest.found && squared[l] == best && i >= nearest.triangle)) continue;
        best = squared[l];
        nearest.found = true;
        nearest.triangle = i;
      }
    }
  }
  if (!nearest.found) return nearest;
  const Index3& t = surface.triangles()[nearest.triangle];
  nearest.point = closestOnTriangle(p, position[static_cast<std::size_t>(t[0])],
                                    position[static_cast<std::size_t>(t[1])], position[static_cast<std::size_t>(t[2])]);
  const Vec3 out = pseudonormal(surface, position, nearest.triangle, nearest.point.feature);
  nearest.inside = (p - nearest.point.point).dot(out) < 0.0;
  return nearest;
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_normal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/contact/triangle_lanes.h"
#include "sim/math/elementary.h"

namespace calot {

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

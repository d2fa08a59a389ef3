// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/shaft_contact.h"

#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"

namespace calot {

namespace {

constexpr double slack = 1e-9;  // m^2: a neighbour that is nearer by less counts as equally near

/// Does the surface around the feature lead nearer to the point on the axis?
bool isLocalMinimum(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                    const SegmentTriangle& found) {
  if (found.feature == TriangleFeature::face) return true;
  const Index3& t = surface.triangles()[triangle];
  const Vec3 away = found.onSegment - found.onTriangle;
  const auto at = [&](int node) -> const Vec3& { return position[static_cast<std::size_t>(node)]; };
  const auto feature = static_cast<int>(found.feature);
  if (feature <= static_cast<int>(TriangleFeature::edge2)) {
    const int k = feature - static_cast<int>(TriangleFeature::edge0);
    const int third = surface.opposite(triangle, k);
    if (third < 0) return true;
    const Vec3 edge = at(t[(k + 1) % 3]) - at(t[k]);
    Vec3 inward = at(third) - at(t[k]);
    inward -= edge * (inward.dot(edge) / edge.squaredNorm());
    return away.dot(inward) <= slack;
  }
  const int k = feature - static_cast<int>(TriangleFeature::vertex0);
  for (const int n : surface.neighbours(t[k])) {
    if (away.dot(at(n) - at(t[k])) > slack) return false;
  }
  return true;
}

}  // namespace

void shaftContacts(const ContactSurface& surface, std::span<const Vec3> position,
                   std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double radius, double reach,
                   std::uint32_t piece, std::vector<ShaftContact>& out) {
  const std::size_t start = out.size();
  Box sweep;
  sweep.include(p0);
  sweep.include(p1);
  sweep.grow(radius + reach);
  const double farthest = radius + reach;
  for (const std::uint32_t p : patches) {
    const ContactSurface::Patch& patch = surface.patches()[p];
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      const Index3& t = surface.triangles()[i];
      const Vec3& a = position[static_cast<std::size_t>(t[0])];
      const Vec3& b = position[static_cast<std::size_t>(t[1])];
      const Vec3& c = position[static_cast<std::size_t>(t[2])];
      Box box;
      box.include(a);
      box.include(b);
      box.include(c);
      if (!sweep.overlaps(box)) continue;
      const Vec3 area = (b - a).cross(c - a);
      const double length = area.norm();
      if (!(length > 1e-18)) continue;
      const Vec3 outward = area / length;
      const SegmentTriangle found = closestSegmentTriangle(p0, p1, a, b, c);
      if (!(found.squaredDistance <= farthest * farthest)) continue;
      ShaftContact contact;
      if (found.crosses) {
        // The axis passes through the face: the inner end says how deep, the face which way is out.
        const double depth = std::max(-(p0 - a).dot(outward), -(p1 - a).dot(outward));
        contact.normal = outward;
        contact.gap = -std::min(depth, radius) - radius;
        contact.onAxis = found.onSegment;
      } else {
        const Vec3 away = found.onSegment - found.onTriangle;
        const double distance = std::sqrt(found.squaredDistance);
        const double side = away.dot(outward);
        if (side > 0.0 && distance > 1e-9) {
          if (!isLocalMinimum(surface, position, i, found)) continue;
          contact.normal = away / distance;
          contact.gap = distance - radius;
        } else {
          if (found.feature != TriangleFeature::face || distance > radius) continue;
          contact.normal = outward;
          contact.gap = -distance - radius;
        }
        contact.onAxis = found.onSegment;
      }
      contact.node = {t[0], t[1], t[2]};
      contact.weight = found.barycentric;
      // The feature's name: its nodes. A face by its lowest node and its number would change with the order of the
      // patches, which Model fixes; so the triangle's place serves.
      std::uint64_t feature = 0;
      const auto f = static_cast<int>(found.feature);
      if (f == 0) {
        feature = (std::uint64_t{1} << 50U) | i;
      } else if (f <= 3) {
        const auto u = static_cast<std::uint64_t>(std::min(t[f - 1], t[f % 3]));
        const auto v = static_cast<std::uint64_t>(std::max(t[f - 1], t[f % 3]));
        feature = (std::uint64_t{2} << 50U) | (u << 25U) | v;
      } else {
        feature = (std::uint64_t{3} << 50U) | static_cast<std::uint64_t>(t[f - 4]);
      }
      contact.key = (static_cast<std::uint64_t>(piece) << 56U) | feature;
      out.push_back(contact);
    }
  }
  const auto first = out.begin() + static_cast<std::ptrdiff_t>(start);
  std::stable_sort(first, out.end(), [](const ShaftContact& a, const ShaftContact& b) { return a.key < b.key; });
  out.erase(std::unique(first, out.end(), [](const ShaftContact& a, const ShaftContact& b) { return a.key == b.key; }),
            out.end());
}

double leastGap(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
                const Vec3& p0, const Vec3& p1, double radius, double reach) {
  std::vector<ShaftContact> found;
  shaftContacts(surface, position, patches, p0, p1, radius, std::max(reach, 0.0), 0, found);
  double least = reach;
  for (const ShaftContact& c : found) least = std::min(least, c.gap);
  return least;
}

}  // namespace calot

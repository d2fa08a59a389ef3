// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow phase: a capsule (a piece of an instrument) against a deforming surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/math/linear.h"

namespace calot {

/// Depth below the surface down to which a capsule's axis is recognised as inside (m).
inline constexpr double maxAxisDepth = 0.005;

/// A contact point of a capsule and a surface.
struct SurfaceContact {
  std::array<int, 3> node{};   ///< corners of the triangle
  Vec3 weight = Vec3::Zero();  ///< barycentric coordinates of the surface point
  Vec3 normal =
      Vec3::Zero();  ///< unit, from the organ towards the capsule; along the shortest way out when the axis is inside
  Vec3 onAxis = Vec3::Zero();  ///< point of the capsule's axis (m)
  double gap = 0.0;            ///< distance of the surfaces, negative inside (m)
  /// Bits 56 to 63: the capsule's piece; 52 to 55: zero, the caller's; below: the contact point. Two steps with equal
  /// keys have the same contact point: outside, the surface's feature; inside, the point of the axis.
  std::uint64_t key = 0;
};

/// Margin by which the segment's box must be grown to find every relevant patch (m).
[[nodiscard]] inline double capsuleSearch(double radius, double reach) {
  return std::max(radius + reach, maxAxisDepth);
}

/// Finds the contacts of the capsule around segment p0-p1 with the triangles of the given patches.
///
/// Outside, a contact of the axis is a local minimum of the distance over the surface: the foot point of a face
/// lies inside it, and at an edge or a vertex no neighbouring triangle is nearer. A flat region thus gives one contact
/// rather than one per triangle, and no contact stops a capsule that merely passes by.
///
/// Inside (the axis crosses the surface, or its nearest feature's pseudonormal says so), contacts are the
/// crossings, with their face's normal, and the ends and the middle of each part inside, each with the way out to its
/// nearest surface point: gap = -depth - radius. The nearest surface point is never on the far side of a thin part. An
/// end deeper than maxAxisDepth is measured from the plane of the face through which the axis entered, with its depth
/// capped at maxAxisDepth. An axis that is entirely deeper is not detected. Foot points within 1 um of each other with
/// the same normal are merged.
/// @param patches indices; those near the segment's box grown by capsuleSearch()
/// @param reach contacts with a larger gap are omitted (m)
/// @param piece number of the capsule's piece, part of the key Results are appended in order of their
/// keys, each key once.
void capsuleContacts(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double radius,
                     double reach, std::uint32_t piece, std::vector<SurfaceContact>& out);

/// Nearest the surface comes to the axis p0-p1.
struct AxisDistance {
  bool found = false;     ///< within the limit
  bool inside = false;    ///< the axis crosses the surface, or lies on its inner side
  double distance = 0.0;  ///< of axis and triangles, not signed; the limit where nothing is found (m)
};
AxisDistance axisDistance(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double limit);

/// Smallest signed gap of the capsule over the triangles of the given patches, defined as above; at most `reach`.
double minGap(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
              const Vec3& p0, const Vec3& p1, double radius, double reach);

}  // namespace calot

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

/// A capsule's axis is recognised as inside down to this depth below the surface (m).
inline constexpr double deepestAxis = 0.005;

/// One place where a capsule may touch a surface.
struct SurfaceContact {
  std::array<int, 3> node{};   ///< corners of the triangle
  Vec3 weight = Vec3::Zero();  ///< barycentric coordinates of the surface point
  Vec3 normal = Vec3::Zero();  ///< unit, from the organ towards the capsule; the way out when the axis is inside
  Vec3 onAxis = Vec3::Zero();  ///< point of the capsule's axis (m)
  double gap = 0.0;            ///< distance of the surfaces, negative inside (m)
  /// Bits 56 to 63: the capsule's piece; 52 to 55: zero, the caller's; below: the place. Equal in two steps means the
  /// same place: outside, the surface's feature; inside, the point of the axis.
  std::uint64_t key = 0;
};

/// How far a capsule's segment's box must be grown so that its patches hold all that counts (m).
[[nodiscard]] inline double capsuleSearch(double radius, double reach) { return std::max(radius + reach, deepestAxis); }

/// Finds the contacts of the capsule around segment p0-p1 with the triangles of the given patches.
///
/// Where the axis is outside, a pair counts where the distance from it is a local minimum over the surface: for a face
/// the foot point is inside it, for an edge or a vertex no neighbouring triangle leads nearer. So a flat region gives
/// one contact, not one for each triangle around, and no contact stops a capsule that merely passes by.
///
/// Where the axis is inside (it crosses the surface, or its nearest feature's pseudonormal says so), contacts are the
/// crossings, with their face's normal, and the ends and the middle of each part inside, each with the way out to its
/// nearest surface point: gap = -depth - radius. Being the nearest, that is never the far side of a thin part. An end
/// deeper than deepestAxis is counted from the plane of the face through which the axis came, as if at that depth; an
/// axis wholly deeper than that is not seen.
/// Feet within a micrometre of one another with one normal are one contact.
/// @param patches indices; those near the segment's box grown by capsuleSearch()
/// @param reach contacts with a larger gap are left out (m)
/// @param piece number of the capsule's piece, part of the key
/// Results are appended in order of their keys, each key once.
void capsuleContacts(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double radius,
                     double reach, std::uint32_t piece, std::vector<SurfaceContact>& out);

/// The smallest signed gap of the capsule over the given patches' triangles (as above), or `reach` when there is none
/// nearer.
double leastGap(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
                const Vec3& p0, const Vec3& p1, double radius, double reach);

}  // namespace calot

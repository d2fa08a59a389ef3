// SPDX-License-Identifier: GPL-3.0-or-later
// Narrow phase: a capsule (a piece of an instrument's shaft) against a deforming surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/math/linear.h"

namespace calot {

/// One place where a shaft may touch a surface: a local minimum of the distance between them.
struct ShaftContact {
  std::array<int, 3> node{};   ///< corners of the triangle
  Vec3 weight = Vec3::Zero();  ///< barycentric coordinates of the surface point
  Vec3 normal = Vec3::Zero();  ///< unit, from the organ towards the shaft
  Vec3 onAxis = Vec3::Zero();  ///< point of the shaft's axis (m)
  double gap = 0.0;            ///< distance of the surfaces, negative inside (m)
  std::uint64_t key = 0;  ///< the surface feature and the piece of the shaft: equal in two steps means the same place
};

/// Finds the contacts of the capsule around segment p0-p1 with the triangles of the given patches.
///
/// A pair counts where the distance from the axis is a local minimum over the surface: for a face the foot point is
/// inside it, for an edge or a vertex no neighbouring triangle leads nearer. So a flat region gives one contact, not
/// one for each triangle around, and no contact stops a shaft that merely passes by. A foot point on the inner side of
/// its face counts as penetration as long as it is no deeper than `radius` below the surface (deeper ones are the far
/// side of a thin part).
/// @param reach contacts with a larger gap are left out (m)
/// @param piece number of the shaft's piece, part of the key
/// Results are appended in order of their keys, each key once.
void shaftContacts(const ContactSurface& surface, std::span<const Vec3> position,
                   std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double radius, double reach,
                   std::uint32_t piece, std::vector<ShaftContact>& out);

/// The smallest signed gap of the capsule over the given patches' triangles (as above), or `reach` when there is none
/// nearer.
double leastGap(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
                const Vec3& p0, const Vec3& p1, double radius, double reach);

}  // namespace calot

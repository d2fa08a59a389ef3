// SPDX-License-Identifier: GPL-3.0-or-later
// Features of a closed surface near a point: which side it is on, and whether it is nearest there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

/// Outward unit normal of a triangle; zero where it has no area to speak of (below 1e-18 m^2).
Vec3 faceNormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle);

/// Outward pseudonormal of a feature, not of unit length: a face's normal, the sum of both normals at an edge, the
/// angle-weighted sum at a vertex (Baerentzen and Aanaes 2005). For a point whose nearest point of the surface lies on
/// this feature, the sign of (point - nearest) . pseudonormal tells outside (positive) from inside.
Vec3 pseudonormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                  TriangleFeature feature);

/// Is a feature's nearest point a local minimum of the distance over the surface? No triangle around it leads nearer.
/// @param away from that point to the one that is held against the surface (m)
bool isLocalMinimum(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                    TriangleFeature feature, const Vec3& away);

/// Name of a feature, the same whichever of its triangles it was met from: faces, edges and vertices in the two bits
/// from 50 up (1, 2, 3), below them the triangle's name (ContactSurface::name()), the edge's nodes, the node.
std::uint64_t featureKey(const ContactSurface& surface, std::size_t triangle, TriangleFeature feature);

/// The nearest point of the given patches' triangles to p.
struct NearestPoint {
  std::size_t triangle = 0;
  PointTriangle point;
  bool found = false;
  bool inside = false;  ///< on the inner side of the nearest feature
};
/// @param limit nothing farther counts (m). Ties go to the lower triangle.
NearestPoint nearestPoint(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p, double limit);

}  // namespace calot

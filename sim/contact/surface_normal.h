// SPDX-License-Identifier: GPL-3.0-or-later
// Features of a closed surface near a point: normals, sides and local minima of the distance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

/// Outward unit normal of a triangle; zero if twice its area is below 1e-18 m^2.
Vec3 faceNormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle);

/// Outward pseudonormal of a feature, not of unit length: a face's normal, the sum of both normals at an edge, the
/// angle-weighted sum at a vertex (Baerentzen and Aanaes 2005). For a point whose nearest point of the surface lies on
/// this feature, (point - nearest) . pseudonormal is positive outside and negative inside.
Vec3 pseudonormal(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                  TriangleFeature feature);

/// True if a feature's nearest point is a local minimum of the distance over the surface, so that no triangle
/// around it is nearer?
/// @param away vector from that point to the query point (m)
bool isLocalMinimum(const ContactSurface& surface, std::span<const Vec3> position, std::size_t triangle,
                    TriangleFeature feature, const Vec3& away);

/// Key of a feature, independent of the triangle from which it was found. Bits 50 and 51: 1 face, 2 edge, 3 vertex.
/// Below: the triangle's name (ContactSurface::name()), the edge's nodes or the node.
std::uint64_t featureKey(const ContactSurface& surface, std::size_t triangle, TriangleFeature feature);

/// The nearest point of the given patches' triangles to p.
struct NearestPoint {
  std::size_t triangle = 0;
  PointTriangle point;
  bool found = false;
  bool inside = false;  ///< on the inner side of the nearest feature
};
/// @param limit maximum distance (m). Ties go to the triangle with the lower index.
NearestPoint nearestPoint(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p, double limit);

}  // namespace calot

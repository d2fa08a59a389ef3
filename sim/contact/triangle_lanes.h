// SPDX-License-Identifier: GPL-3.0-or-later
// Squared distances of eight triangles at once. The bits are those of the scalar functions of
// sim/geometry/closest_point.h (tests/sim/contact/triangle_lanes_test.cpp): lanes select the relevant triangles, and
// scalar code then evaluates foot points and features of those few.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/contact/surface_patches.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

using LaneValues = std::array<double, laneCount>;

/// Eight triangles: corner, coordinate, lane (m).
struct TriangleLanes {
  alignas(64) double corner[3][3][laneCount];
};

/// Eight boxes: coordinate, lane (m).
struct BoundsLanes {
  alignas(64) double lower[3][laneCount];
  alignas(64) double upper[3][laneCount];
};

/// Triangles of a patch whose boxes overlap `box`, ascending, written to `near`. @return how many
std::size_t trianglesInBox(const ContactSurface& surface, std::span<const Vec3> position, std::uint32_t patch,
                           const Box& box, std::array<std::uint32_t, ContactSurface::maxPatchTriangles>& near);

/// Takes in up to eight triangles; lanes that are left over repeat the last. @pre triangles is not empty
void gatherTriangles(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> triangles, TriangleLanes& out);

/// The box of each triangle.
void boxesOf(const TriangleLanes& triangles, BoundsLanes& out);

/// True if the triangle of a lane is so flat (sine of its angle below 1e-3) that rounding moves the foot of
/// a perpendicular on it?
bool isSliver(const TriangleLanes& triangles, std::size_t lane);

/// A little less than the squared distance of p from each box, so that rounding loses no triangle (m^2).
void boxDistances(const BoundsLanes& boxes, const Vec3& p, LaneValues& squared);

/// closestSegmentTriangle(p0, p1, triangle).squaredDistance of each lane (m^2).
void segmentTriangleDistances(const TriangleLanes& triangles, const Vec3& p0, const Vec3& p1, LaneValues& squared);

/// closestOnTriangle(p, triangle).squaredDistance of each lane (m^2).
void pointTriangleDistances(const TriangleLanes& triangles, const Vec3& p, LaneValues& squared);

}  // namespace calot

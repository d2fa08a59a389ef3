// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of more than three corners, as triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/linear.h"

namespace calot::recorder {

enum class PolygonCut : std::uint8_t {
  fan,      ///< kept: no triangle of the fan folds back
  concave,  ///< cut into triangles that lie inside the polygon
  crossing  ///< kept although it folds: the polygon crosses itself
};

/// Squares of the corners of concave polygons that a file may have in all: the time grows with them (seconds).
inline constexpr double maxConcaveWork = 1e9;

/// Cuts a polygon by diagonals from its lowest corner (O'Rourke, "Computational Geometry in C", 1998, chapter 1), in
/// the plane of two axes that it faces most: coordinates are not rounded. Holes joined to the rim by a bridge, corners
/// on a line and corners named twice are polygons like others.
/// @param fan (c0, c1, c2), (c0, c2, c3), ...
[[nodiscard]] PolygonCut cutPolygon(const std::vector<Vec3>& vertex, std::span<Index3> fan);

/// Does a triangle of the fan fold back over others?
[[nodiscard]] bool fanFolds(const std::vector<Vec3>& vertex, std::span<const Index3> fan);

}  // namespace calot::recorder

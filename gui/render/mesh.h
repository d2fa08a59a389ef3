// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sim/math/linear.h"

namespace calot::gui {

/// A triangle mesh in a frame of its own (m), with unit normals.
struct Mesh {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;
  std::vector<Index3> triangle;  ///< counter-clockwise from outside
};

/// Unit normals of vertices: sums of the triangles' area vectors, in the triangles' order. A vertex
/// without area gets z.
[[nodiscard]] std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle);

/// From a frame whose z is up to W. @param down where gravity pulls in W, unit
[[nodiscard]] inline Quat upright(const Vec3& down) { return Quat::FromTwoVectors(-Vec3::UnitZ(), down); }

/// Two triangles for each cell of a grid, whose vertices stand row by row, so many in each.
/// @param closed the last vertex of a row is joined to its first
[[nodiscard]] std::vector<Index3> gridTriangles(int rows, int columns, bool closed);

}  // namespace calot::gui

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

/// Adds triangles, two for each cell of a grid whose vertices the mesh has, row by row, and normals.
/// @param closed the last vertex of a row is joined to its first
void closeGrid(Mesh& mesh, int rows, int columns, bool closed);

/// A closed curve around a path: point k of n, counter-clockwise seen from the path's end.
using Ring = std::vector<Vec3>;

/// Skin over rings of equal size along a path, with smooth normals, and flat caps at both ends.
/// @pre at least two rings of at least three points
[[nodiscard]] Mesh loft(const std::vector<Ring>& rings);

/// n points of |x / a|^e + |y / b|^e = 1 around (centre.x, centre.y) in the plane z = centre.z; e = 2 is an ellipse,
/// larger values near a rectangle.
[[nodiscard]] Ring superellipse(const Vec3& centre, double a, double b, double e, int n);

/// A tube of circular section along a path of points (m). Sections stand across the path; ends are rounded.
/// @pre at least two points, none equal to its neighbour
[[nodiscard]] Mesh tube(const std::vector<Vec3>& path, double radius, int n);

/// Rigid motion of a mesh.
[[nodiscard]] Mesh moved(Mesh mesh, const Quat& rotation, const Vec3& translation);

}  // namespace calot::gui

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

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
// Does a surface pass through itself?
#pragma once

#include <cstddef>

#include "sim/geometry/triangle_mesh.h"

namespace calot {

struct SelfCrossing {
  std::size_t pairs = 0;  ///< pairs of triangles that cross; at most the limit
  int first = -1;         ///< the first such pair found, in the order of the sweep; -1: none
  int second = -1;
  Vec3 where = Vec3::Zero();  ///< of it, on both triangles (m)
};

/// Pairs of triangles of which an edge of one passes through the inside of the other, found by sweeping along the
/// longest axis of the bounds. Triangles that only touch (in a point, along an edge, coplanar) or share an edge do not
/// cross. Cost grows with the pairs whose bounds overlap along that axis.
/// @param maxPairs stop after this many pairs
/// @pre indices are in range, coordinates finite
[[nodiscard]] SelfCrossing findSelfCrossing(const TriangleMesh& mesh, std::size_t maxPairs = 1000);

}  // namespace calot

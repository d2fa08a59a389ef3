// SPDX-License-Identifier: GPL-3.0-or-later
// The union of closed surfaces that pass through each other.
#pragma once

#include <vector>

#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// The surface around all that is inside at least one of these; intersections are computed exactly and rounded once.
/// @param piece at least one; each closed, manifold and outward
/// @throws Error (refused): a piece crosses itself, the union has edges of more than two triangles, or the
/// library fails on them (programs run it in a child process)
[[nodiscard]] TriangleMesh uniteSurfaces(const std::vector<TriangleMesh>& piece);

}  // namespace calot::recorder

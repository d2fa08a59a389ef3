// SPDX-License-Identifier: GPL-3.0-or-later
// A coarser surface of an organ: preparing and drawing take with its triangles.
#pragma once

#include <string>

#include "sim/geometry/triangle_mesh.h"

namespace calot::apps {

struct CoarseSurface {
  std::string error;  ///< empty: the surface is good
  TriangleMesh mesh;
};

/// A closed surface of about so many triangles: the boundary of a tetrahedral mesh (mesh_to_count.h) of the same
/// volume within 1 %. Thin parts go as they do there.
/// @param surface closed, outward, manifold
[[nodiscard]] CoarseSurface coarseSurface(const TriangleMesh& surface, int triangles);

}  // namespace calot::apps

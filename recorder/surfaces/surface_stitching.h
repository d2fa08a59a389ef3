// SPDX-License-Identifier: GPL-3.0-or-later
// Edges of a surface that have not two triangles.
#pragma once

#include <string>
#include <vector>

#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// Has every edge two triangles, which agree on what is outside?
[[nodiscard]] bool hasSoundEdges(const TriangleMesh& mesh);

/// Vertices at exactly one place become the first of them. @return how many became another
int weldVertices(TriangleMesh& mesh);

/// Corners on open edges that differ by rounding become one, within the least tolerance, up to 1e-4 of the surface's
/// diagonal, that leaves the fewest open edges and makes no edge of more than two triangles.
void stitchEdges(TriangleMesh& mesh, std::vector<std::string>& notes);

/// Edges of more than two triangles: drops walls whose both sides lie inside the surface, and gives parts that touch in
/// an edge vertices of their own. What makes other edges open is left as it is.
/// @return whether the mesh changed
bool separateParts(TriangleMesh& mesh, std::vector<std::string>& notes);

}  // namespace calot::recorder

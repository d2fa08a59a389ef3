// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a surface, and how closed ones lie to each other.
#pragma once

#include <string>
#include <vector>

#include "sim/geometry/surface_report.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// Triangles that edges connect.
struct SurfacePart {
  TriangleMesh mesh;    ///< outward, where it is closed
  bool inward = false;  ///< in the file
  int turned = 0;       ///< triangles that the file has the other way round
  bool united = false;  ///< joined of several: crosses itself by rounding at most
};

/// Parts in the order of their first triangles, each repaired by itself (repairSurface) unless its edges are sound.
/// @param[in,out] repair what was done is added, turned triangles apart
[[nodiscard]] std::vector<SurfacePart> partsOf(const TriangleMesh& mesh, SurfaceRepair& repair);

[[nodiscard]] TriangleMesh joined(const std::vector<SurfacePart>& parts);

/// Joins parts that pass through each other where each is sound, turns cavities inward, leaves out what lies inside a
/// solid part.
/// @pre edges are sound
/// @throws Error (failure): what joins them is not installed
void arrangeParts(std::vector<SurfacePart>& parts, std::vector<std::string>& notes);

}  // namespace calot::recorder

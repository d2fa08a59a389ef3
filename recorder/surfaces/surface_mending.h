// SPDX-License-Identifier: GPL-3.0-or-later
// A surface as a file has it, made into one that bounds bodies: what `calot mesh` does to it, with a word for each
// deed. Scenes load surfaces as they are.
#pragma once

#include <string>
#include <vector>

#include "sim/geometry/surface_report.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

struct MendedSurface {
  TriangleMesh mesh;               ///< closed and outward, or with the open and shared edges that are left
  SurfaceRepair repair;            ///< counts of the repairs that invent nothing; its mesh is empty
  std::vector<SurfaceHole> holes;  ///< filled or not
  SelfCrossing crossing;           ///< of a closed surface
  std::vector<std::string> notes;  ///< what else was done, one line each
};

/// - A surface whose edges are sound keeps its vertices. Of others those at one place are welded; where edges are open
///   still, corners on them that are equal but for rounding, within the least tolerance that closes most.
/// - Of edges with more than two triangles, walls inside the body are dropped, and parts that touch are separated.
/// - With `fill` holes are filled.
/// - Closed parts that pass through each other are joined (uniteSurfaces). A part inside another one is its cavity
/// where
///   the file turns it the other way, and else left out: the other one is solid.
/// @throws Error as arrangeParts()
[[nodiscard]] MendedSurface mendSurface(const TriangleMesh& read, bool fill);

}  // namespace calot::recorder

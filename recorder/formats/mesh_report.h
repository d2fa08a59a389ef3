// SPDX-License-Identifier: GPL-3.0-or-later
// Report of `calot mesh` about a surface and its mesh, as JSON and as text.
#pragma once

#include <string>

#include "sim/geometry/mesh_to_count.h"
#include "sim/geometry/surface_report.h"

namespace calot::recorder {

struct MeshReport {
  std::string input;     ///< the file's name
  std::string unit;      ///< as given: m, cm, mm
  std::string output;    ///< empty when nothing was written
  SurfaceReport found;   ///< the surface as it was read
  SurfaceRepair repair;  ///< repairs before meshing
  StuffedMesh stuffed;   ///< the mesh, or why there is none
};

/// One JSON object (docs/reference/meshing.md lists its members), with a line break at the end.
std::string meshReportJson(const MeshReport& report);

/// The same as text of several lines.
std::string meshReportText(const MeshReport& report);

/// Repairs of the surface, or empty: "12 vertices welded, 3 triangles turned".
std::string repairSummary(const SurfaceRepair& repair);

}  // namespace calot::recorder

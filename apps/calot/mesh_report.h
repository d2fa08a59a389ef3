// SPDX-License-Identifier: GPL-3.0-or-later
// Report of `calot mesh` about a surface and its mesh, as JSON and as text.
#pragma once

#include <string>
#include <vector>

#include "apps/calot/command.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_report.h"

namespace calot::apps {

struct MeshReport {
  std::string input;                ///< the file's name
  std::string unit;                 ///< as given: m, cm, mm
  std::string output;               ///< empty when no mesh was written
  SurfaceReport found;              ///< the surface as it was read
  SurfaceRepair repair;             ///< repairs before meshing that invent nothing
  std::vector<SurfaceHole> holes;   ///< of the repaired surface
  SelfCrossing crossing;            ///< of the surface that is meshed
  StuffedMesh stuffed;              ///< the mesh, or why there is none; without tetrahedra none was asked for
  std::string surfaceOutput;        ///< empty when no surface was written
  int surfaceTriangles = 0;         ///< of what was written
  double surfaceOutputVolume = 0;   ///< m^3
  std::vector<std::string> faults;  ///< why there is no mesh or surface
};

/// Its members: docs/reference/meshing.md.
Json meshReportJson(const MeshReport& report);

/// The same as text of several lines.
std::string meshReportText(const MeshReport& report);

/// Differences between output and input, one line each: parts that were dropped or are too thin,
/// holes that were filled, a surface that crosses itself.
std::vector<std::string> meshWarnings(const MeshReport& report);

/// "70 edges around (12.1, -3.4, 50.0) mm".
std::string wordsFor(const SurfaceHole& hole);

}  // namespace calot::apps

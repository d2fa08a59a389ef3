// SPDX-License-Identifier: GPL-3.0-or-later
// The report of `calot mesh`: the surface as it was read, and what was made of it.
#pragma once

#include <string>
#include <vector>

#include "apps/calot/command.h"
#include "recorder/surfaces/surface_mending.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_report.h"

namespace calot::apps {

/// A surface and what `calot mesh` made of it.
struct MeshReport {
  std::string input;                ///< the file's name
  std::string unit;                 ///< as given: m, cm, mm
  std::string output;               ///< empty when no mesh was written
  SurfaceReport found;              ///< the surface as it was read
  std::vector<std::string> notes;   ///< what reading did to it
  recorder::MendedSurface mended;   ///< the surface that is meshed, and what was done to it
  StuffedMesh stuffed;              ///< the mesh, or the reason for its absence; empty without --tetrahedra
  std::string surfaceOutput;        ///< empty when no surface was written
  int surfaceTriangles = 0;         ///< of what was written
  double surfaceOutputVolume = 0;   ///< m^3
  std::vector<std::string> faults;  ///< why there is no mesh or surface
};

/// "70 edges around (12.1, -3.4, 50.0) mm".
std::string wordsFor(const SurfaceHole& hole);

/// Differences between output and input, one line each: what was done to the surface, parts that were dropped or are
/// too thin, holes that were filled, a surface that crosses itself.
std::vector<std::string> meshWarnings(const MeshReport& report);

/// Its members: docs/reference/meshing.md.
Json meshReportJson(const MeshReport& report);

/// The same as text of several lines.
std::string meshReportText(const MeshReport& report);

}  // namespace calot::apps

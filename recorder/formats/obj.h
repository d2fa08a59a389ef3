// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ surfaces. Read: `v` (3 coordinates; more numbers are ignored), `f` (v, v/vt, v//vn, v/vt/vn; negative
// indices count back; polygons are cut into fans). Everything that only draws (`vt`, `vn`, groups, materials, lines,
// points) is passed over; anything else is refused.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

using ObjLimits = SurfaceLimits;

/// A surface from an OBJ file's bytes, in metres. Indices are in range and coordinates finite; nothing else is
/// guaranteed (surface_report.h checks the surface).
/// @param name name for messages
/// @throws Error (damaged): "name:line: what is wrong"
TriangleMesh parseObj(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const ObjLimits& limits = {});

/// The text of an OBJ file in metres. Coordinates are written so that they are read back bit for bit.
/// @param comment lines for the head, each without "#"
std::string formatObj(const TriangleMesh& mesh, const std::string& comment);

}  // namespace calot::recorder

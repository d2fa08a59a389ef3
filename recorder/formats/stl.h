// SPDX-License-Identifier: GPL-3.0-or-later
// STL surfaces, ASCII and binary. An STL file has no vertices, only corners: those at exactly one place become one
// vertex, in order of first mention, as without that no edge would have two triangles. Normals, the header and
// attribute bytes are passed over; several solids in a text file are one surface.
//
// Binary is what has exactly the length that its number of triangles demands (84 + 50 n bytes); that some exporters
// begin such files with "solid" does not matter.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "recorder/formats/surface_limits.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// A surface from an STL file's bytes, in metres. Coordinates are finite; nothing else is promised (surface_report.h
/// says what is wrong with it: triangles whose corners fell together are kept).
/// @param name what messages call it
/// @throws Error (damaged): "name:line: what is wrong", or "name: triangle n: what is wrong" (from 0) in binary files
TriangleMesh parseStl(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits = {});

}  // namespace calot::recorder

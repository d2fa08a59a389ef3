// SPDX-License-Identifier: GPL-3.0-or-later
// STL surfaces, ASCII and binary. An STL file has no vertices, only corners: those at exactly one position become one
// vertex, in order of first mention; otherwise no edge would have two triangles. Normals, the header and attribute
// bytes are passed over; several solids in a text file are one surface.
//
// A file is binary if its length matches its number of triangles (84 + 50 n bytes), even if it starts with "solid" as
// some exporters write.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// A surface from an STL file's bytes, in metres. Coordinates are finite; nothing else is guaranteed (surface_report.h
/// checks the surface; triangles with coincident corners are kept).
/// @param name what messages call it
/// @throws Error (damaged): "name:line: what is wrong", or "name: triangle n: what is wrong" (from 0) in binary files
TriangleMesh parseStl(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits = {});

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// PLY surfaces: format 1.0, ascii, binary_little_endian and binary_big_endian. Wanted are an element `vertex` with x, y
// and z and an element `face` with the list `vertex_indices` (or `vertex_index`), in either order; polygons are cut
// into fans. Every other property and element is passed over (triangle strips among them: a file with those alone has
// no face, and is refused).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// A surface from a PLY file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised.
/// @param name what messages call it
/// @throws Error (damaged): "name:line: what is wrong"; after the header of a binary file "name: vertex n: what is
/// wrong" (elements are counted from 0)
TriangleMesh parsePly(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits = {});

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces by the name of their file: .obj, .stl, .ply (small or capital letters).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "recorder/formats/surface_limits.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::recorder {

/// Does the name end as one of the known formats does?
bool isSurfaceName(const std::string& name);

/// A surface from a file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised.
/// @param name what messages call it; its end says the format
/// @throws Error (damaged), naming the place, or where the name is none of a surface file
TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits = {});

}  // namespace calot::recorder

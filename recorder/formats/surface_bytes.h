// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces by the name of their file: .obj, .stl, .ply (small or capital letters).
// Common to the readers of triangle surfaces (OBJ, STL, PLY): the unit, which such files do not contain, and limits.
// Wavefront OBJ surfaces. Read: `v` (3 coordinates; more numbers are ignored), `f` (v, v/vt, v//vn, v/vt/vn; negative
// indices count back; polygons are cut into fans). Everything that only draws (`vt`, `vn`, groups, materials, lines,
// points) is passed over; anything else is refused.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/record.h"

namespace calot::recorder {

/// A surface file contains no unit; whoever names the file must state it.
enum class LengthUnit { metre, centimetre, millimetre };

/// Metres in one unit.
double metres(LengthUnit unit);

/// "m", "cm" and "mm".
const FieldWords& lengthUnits();

/// One of lengthUnits(). @throws Error (invalid)
LengthUnit parseLengthUnit(const std::string& word);

/// Limits of a file; a file that exceeds one is refused, naming the location.
struct SurfaceLimits {
  std::size_t bytes = std::size_t{256} << 20U;
  std::size_t vertices = 5'000'000;
  std::size_t triangles = 10'000'000;
};

/// Greatest distance from the origin: no organ is farther, and sums of squares stay far from overflow (m).
inline constexpr double farthestCoordinate = 1000.0;

/// Does the name end as one of the known formats does?
bool isSurfaceName(const std::string& name);

/// A surface from a file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised.
/// @param name what messages call it; its end says the format
/// @throws Error (damaged), naming the place, or if the name is not that of a surface file
TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits = {});

/// A surface from an OBJ file's bytes, in metres. Indices are in range and coordinates finite; nothing else is
/// guaranteed (surface_report.h checks the surface).
/// @param name name for messages
/// @throws Error (damaged): "name:line: what is wrong"
TriangleMesh parseObj(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits = {});

/// The text of an OBJ file in metres. Coordinates are written so that they are read back bit for bit.
/// @param comment lines for the head, each without "#"
std::string formatObj(const TriangleMesh& mesh, const std::string& comment);

}  // namespace calot::recorder

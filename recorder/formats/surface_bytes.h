// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces by the name of their file: .obj, .stl, .ply (small or capital letters).
//
// OBJ (Wavefront): `v` (3 coordinates; more numbers are ignored) and `f` (v, v/vt, v//vn, v/vt/vn; negative indices
// count back; polygons are cut into fans) are read. Everything that only draws (`vt`, `vn`, groups, materials, lines,
// points) is passed over; anything else is refused.
//
// STL, ASCII and binary, has no vertices, only corners: those at exactly one position become one vertex, in order of
// first mention; otherwise no edge would have two triangles. Normals, the header and attribute bytes are passed over;
// several solids in a text file are one surface. A file is binary if its length matches its number of triangles (84 +
// 50 n bytes), even if it starts with "solid" as some exporters write.
//
// PLY 1.0 (ascii, binary_little_endian, binary_big_endian): wanted are an element `vertex` with x, y and z and an
// element `face` with the list `vertex_indices` (or `vertex_index`), in either order; polygons are cut into fans. Every
// other property and element is passed over (triangle strips among them: a file with those alone has no face, and is
// refused).
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

/// A surface from a file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised
/// (surface_report.h checks the surface; triangles with coincident corners are kept).
/// @param name what messages call it; its end says the format
/// @throws Error (damaged): "name: line 3: what is wrong", in binary files "name: triangle 0: ..." (STL) or "name:
/// vertex 0: ..." (PLY); or if the name is not that of a surface file
TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits = {});

/// The text of an OBJ file in metres. Coordinates are written so that they are read back bit for bit.
/// @param comment lines for the head, each without "#"
std::string formatObj(const TriangleMesh& mesh, const std::string& comment);

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle surfaces by the name of their file: .obj, .stl, .ply, .off (small or capital letters). Texts may begin with
// a byte order mark. Convex polygons are cut into fans, concave ones as polygon.h says. A file whose head says
// SPACE=LPS (3D Slicer writes it into STL, PLY and OBJ) is turned to RAS: x and y change their signs.
//
// OBJ (Wavefront): `v` (3 coordinates; weights and colours are ignored) and `f` (v, v/vt, v//vn, v/vt/vn; negative
// indices count back) are read, also from lines continued with \ at their ends. Everything that only draws (`vt`, `vn`,
// groups, materials, lines, points) is passed over; anything else is refused.
//
// STL, ASCII and binary, has no vertices, only corners: those at exactly one position become one vertex, in order of
// first mention; otherwise no edge would have two triangles. Normals, the header and attribute bytes are passed over;
// several solids in a text file are one surface. A file is binary if its length matches its number of triangles (84 +
// 50 n bytes), even if it starts with "solid" as some exporters write, or if it is longer and no text.
//
// PLY 1.0 (ascii, binary_little_endian, binary_big_endian): wanted are an element `vertex` with x, y and z and an
// element `face` with the list `vertex_indices` (or `vertex_index`), in either order. Every other property and element
// is passed over (triangle strips among them: a file with those alone has no face, and is refused).
//
// OFF (text): "OFF", also with letters for colours and normals before it, counts, then a line a vertex and a face; what
// follows on these lines is passed over.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

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

/// Says why a file of this name is not read, and what to export instead; empty: it is read.
std::string surfaceNameFault(const std::string& name);

/// A surface from a file's bytes, in metres. Indices are in range and coordinates finite; nothing else is promised
/// (surface_report.h checks the surface; triangles with coincident corners are kept). The same bytes give the same
/// bits.
/// @param name what messages call it; its end says the format
/// @param[in,out] notes what was done to the surface is added: one line each, for people
/// @throws Error (damaged): "name: line 3: what is wrong", in binary files "name: triangle 0: ..." (STL) or "name:
/// vertex 0: ..." (PLY); or if the name is not that of a surface file
TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits = {}, std::vector<std::string>* notes = nullptr);

/// @return how many vertices were in no triangle
int dropUnusedVertices(TriangleMesh& mesh);

/// The text of an OBJ file in metres. Coordinates are written so that they are read back bit for bit.
/// @param comment lines for the head, each without "#"
std::string formatObj(const TriangleMesh& mesh, const std::string& comment);

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/mesh_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>

#include "recorder/base/files.h"

namespace calot::recorder {

TriangleMesh readSurface(const std::filesystem::path& path, LengthUnit unit, const SurfaceLimits& limits,
                         std::vector<std::string>* notes) {
  return parseSurface(readFileBytes(path, path.string(), limits.bytes), path.string(), unit, limits, notes);
}

std::string formatVtk(const TetrahedralMesh& mesh, const std::string& title) {
  std::string line = title.substr(0, 255);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  std::string text;
  text.reserve(64 * mesh.vertex.size() + 32 * mesh.tetrahedron.size() + 512);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n", line,
                 mesh.vertex.size());
  for (const Vec3& p : mesh.vertex) fmt::format_to(out, "{} {} {}\n", p[0], p[1], p[2]);
  fmt::format_to(out, "CELLS {} {}\n", mesh.tetrahedron.size(), 5 * mesh.tetrahedron.size());
  for (const Index4& v : mesh.tetrahedron) fmt::format_to(out, "4 {} {} {} {}\n", v[0], v[1], v[2], v[3]);
  fmt::format_to(out, "CELL_TYPES {}\n", mesh.tetrahedron.size());
  for (std::size_t t = 0; t < mesh.tetrahedron.size(); ++t) text += "10\n";
  return text;
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/mesh.h"

#include <cstddef>

namespace calot::gui {

std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle) {
  std::vector<Vec3> normal(position.size(), Vec3::Zero());
  const auto at = [](auto& list, int i) -> auto& { return list[static_cast<std::size_t>(i)]; };
  for (const Index3& t : triangle) {
    const Vec3 area = (at(position, t[1]) - at(position, t[0])).cross(at(position, t[2]) - at(position, t[0]));
    for (int a = 0; a < 3; ++a) at(normal, t[a]) += area;
  }
  for (Vec3& n : normal) {
    const double length = n.norm();
    n = length > 1e-30 ? Vec3(n / length) : Vec3::UnitZ();
  }
  return normal;
}

std::vector<Index3> gridTriangles(int rows, int columns, bool closed) {
  std::vector<Index3> triangle;
  const auto at = [&](int row, int column) { return row * columns + column % columns; };
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j < (closed ? columns : columns - 1); ++j) {
      triangle.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j));
      triangle.emplace_back(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    }
  }
  return triangle;
}

}  // namespace calot::gui

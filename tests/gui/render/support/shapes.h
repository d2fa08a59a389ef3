// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/scene/scene_view.h"

namespace calot::gui::test {

/// A closed ball: `rings` from pole to pole, twice as many around.
inline SurfaceView sphere(const Vec3& centre, double radius, int rings = 12, const std::string& appearance = "liver") {
  SurfaceView surface;
  surface.organ = surface.appearance = appearance;
  const int segments = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const double polar = std::numbers::pi * i / rings, around = 2.0 * std::numbers::pi * j / segments;
      surface.position.push_back(centre + radius * Vec3(std::sin(polar) * std::cos(around),
                                                        std::sin(polar) * std::sin(around), std::cos(polar)));
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const int a = i * segments + j, b = i * segments + (j + 1) % segments;
      surface.triangle.emplace_back(a, b + segments, b);
      surface.triangle.emplace_back(a, a + segments, b + segments);
    }
  surface.rest = surface.position;
  return surface;
}

/// A sheet of n x n squares over `place(u, v)`, u and v from -0.5 to 0.5.
template <class Place>
SurfaceView sheetOver(const std::string& appearance, int n, const Place& place) {
  SurfaceView surface;
  surface.organ = surface.appearance = appearance;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      surface.position.push_back(place(static_cast<double>(i) / n - 0.5, static_cast<double>(j) / n - 0.5));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      surface.triangle.emplace_back(a, a + n + 1, a + 1);
      surface.triangle.emplace_back(a + 1, a + n + 1, a + n + 2);
    }
  surface.rest = surface.position;
  return surface;
}

/// Within a closed surface; above 0 where its triangles turn outwards (m^3).
inline double volume(const std::vector<Vec3>& position, const std::vector<Index3>& triangle) {
  const auto at = [&](int v) { return position[static_cast<std::size_t>(v)]; };
  double six = 0.0;
  for (const Index3& t : triangle) six += at(t[0]).dot(at(t[1]).cross(at(t[2])));
  return six / 6.0;
}

}  // namespace calot::gui::test

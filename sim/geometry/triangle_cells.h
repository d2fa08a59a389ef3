// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle divided into n^2 equal cells: what happens to a skin is kept by cells, so that it does not depend on how
// large the skin's triangles are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sim/math/linear.h"

namespace calot {

/// The smallest n such that no side of a cell is longer than `longest` (m), at most `most`.
inline std::uint32_t cellsAlongSide(const Vec3& a, const Vec3& b, const Vec3& c, double longest, std::uint32_t most) {
  const double side2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  std::uint32_t n = 1;
  while (n < most && longest * longest * (n * n) < side2) ++n;
  return n;
}

/// Calls visit(cell, weights) for each of the n^2 cells in order: barycentric weights of its centroid, of the corners.
template <class Visit>
void forEachTriangleCell(std::uint32_t n, Visit&& visit) {
  const double size = 1.0 / n;
  std::uint32_t cell = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; i + j < n; ++j) {
      const auto at = [&](double third) {
        const double u = (i + third) * size;
        const double v = (j + third) * size;
        visit(cell++, Vec3(1.0 - (u + v), u, v));
      };
      at(1.0 / 3.0);
      if (i + j + 1 < n) at(2.0 / 3.0);
    }
  }
}

}  // namespace calot

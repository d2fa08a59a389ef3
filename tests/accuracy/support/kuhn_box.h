// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "sim/math/linear.h"

namespace calot::test {

/// Box of nx x ny x nz cubes, each cut into six tetrahedra around its diagonal 000-111 (Kuhn 1960).
struct KuhnBox {
  std::vector<Vec3> node;
  std::vector<Index4> tetrahedron;
  int nx, ny, nz;

  [[nodiscard]] int index(int i, int j, int k) const { return (k * (ny + 1) + j) * (nx + 1) + i; }
  /// Per node: is it of the face where x is least?
  [[nodiscard]] std::vector<bool> firstFace() const {
    std::vector<bool> on(node.size(), false);
    for (int k = 0; k <= nz; ++k) {
      for (int j = 0; j <= ny; ++j) on[static_cast<std::size_t>(index(0, j, k))] = true;
    }
    return on;
  }
};

inline KuhnBox kuhnBox(int nx, int ny, int nz, const Vec3& lower, const Vec3& upper) {
  KuhnBox box{{}, {}, nx, ny, nz};
  const Vec3 size = upper - lower;
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        box.node.emplace_back(lower[0] + size[0] * i / nx, lower[1] + size[1] * j / ny, lower[2] + size[2] * k / nz);
      }
    }
  }
  constexpr std::array<std::array<int, 3>, 6> order{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (const auto& axes : order) {
          std::array<int, 3> at{i, j, k};
          Index4 t;
          t[0] = box.index(at[0], at[1], at[2]);
          for (int s = 0; s < 3; ++s) {
            ++at[static_cast<std::size_t>(axes[static_cast<std::size_t>(s)])];
            t[s + 1] = box.index(at[0], at[1], at[2]);
          }
          const auto p = [&](int c) { return box.node[static_cast<std::size_t>(t[c])]; };
          if ((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0)) < 0.0) std::swap(t[2], t[3]);
          box.tetrahedron.push_back(t);
        }
      }
    }
  }
  return box;
}

}  // namespace calot::test

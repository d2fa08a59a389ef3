// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "sim/solid/elements.h"

namespace calot::test {

/// Box of nx x ny x nz cubes of one size.
struct CubeBox {
  std::vector<Vec3> node;
  std::vector<Index8> cube;
  double edge;
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

inline CubeBox cubeBox(int nx, int ny, int nz, const Vec3& lower, double edge) {
  CubeBox box{{}, {}, edge, nx, ny, nz};
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) box.node.push_back(lower + edge * Vec3(i, j, k));
    }
  }
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        Index8 cube{};
        for (int c = 0; c < 8; ++c) {
          cube[static_cast<std::size_t>(c)] = box.index(i + (c & 1), j + ((c >> 1) & 1), k + ((c >> 2) & 1));
        }
        box.cube.push_back(cube);
      }
    }
  }
  return box;
}

}  // namespace calot::test

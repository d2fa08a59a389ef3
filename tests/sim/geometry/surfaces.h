// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces with known measures, for the tests of this folder.
#pragma once

#include <array>

#include "sim/geometry/triangle_mesh.h"

namespace calot::test {

/// Box with 12 outward triangles.
inline TriangleMesh boxSurface(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertex.emplace_back((i & 1) != 0 ? upper[0] : lower[0], (i & 2) != 0 ? upper[1] : lower[1],
                             (i & 4) != 0 ? upper[2] : lower[2]);
  }
  constexpr std::array<std::array<int, 4>, 6> quads{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& q : quads) {
    mesh.triangle.emplace_back(q[0], q[1], q[2]);
    mesh.triangle.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

/// Octahedron refined `rounds` times, vertices on the sphere: 8 * 4^rounds outward triangles.
inline TriangleMesh refinedSphere(const Vec3& centre, double radius, int rounds) {
  std::vector<std::array<Vec3, 3>> faces;
  for (int i = 0; i < 8; ++i) {
    const Vec3 x = Vec3::UnitX() * ((i & 1) != 0 ? -1.0 : 1.0);
    const Vec3 y = Vec3::UnitY() * ((i & 2) != 0 ? -1.0 : 1.0);
    const Vec3 z = Vec3::UnitZ() * ((i & 4) != 0 ? -1.0 : 1.0);
    const bool flipped = x.cross(y).dot(z) < 0.0;
    faces.push_back(flipped ? std::array<Vec3, 3>{x, z, y} : std::array<Vec3, 3>{x, y, z});
  }
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::array<Vec3, 3>> finer;
    for (const auto& f : faces) {
      const Vec3 a = (f[0] + f[1]).normalized();
      const Vec3 b = (f[1] + f[2]).normalized();
      const Vec3 c = (f[2] + f[0]).normalized();
      finer.push_back({f[0], a, c});
      finer.push_back({a, f[1], b});
      finer.push_back({c, b, f[2]});
      finer.push_back({a, b, c});
    }
    faces = finer;
  }
  TriangleMesh mesh;
  for (const auto& f : faces) {
    Index3 v;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = centre + radius * f[slot(k)];
      int found = -1;
      for (int i = 0; i < mesh.vertices() && found < 0; ++i) {
        if ((mesh.vertex[slot(i)] - p).norm() < 1e-9 * radius) found = i;
      }
      if (found < 0) {
        found = mesh.vertices();
        mesh.vertex.push_back(p);
      }
      v[k] = found;
    }
    mesh.triangle.push_back(v);
  }
  return mesh;
}

/// Both surfaces in one mesh.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const int shift = a.vertices();
  a.vertex.insert(a.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (const Index3& v : b.triangle) a.triangle.emplace_back(v[0] + shift, v[1] + shift, v[2] + shift);
  return a;
}

inline TriangleMesh turned(TriangleMesh mesh) {
  for (Index3& v : mesh.triangle) std::swap(v[1], v[2]);
  return mesh;
}

}  // namespace calot::test

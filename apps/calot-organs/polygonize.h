// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::organs {

using Implicit = std::function<double(const Vec3&)>;

/// One Newton step along the gradient (central differences over a tenth of a millimetre) towards value 0.
inline Vec3 projected(const Implicit& f, const Vec3& p) {
  constexpr double h = 1e-4;
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) gradient[k] = (f(p + h * Vec3::Unit(k)) - f(p - h * Vec3::Unit(k))) / (2.0 * h);
  const double square = gradient.squaredNorm();
  return square > 1e-6 ? Vec3(p - (f(p) / square) * gradient) : p;
}

/// Closed, outward, manifold surface of {f < 0}: the boundary of an isosurface stuffing (no slivers, no cracks), its
/// vertices spread by Laplacian smoothing and put back onto the surface, coordinates rounded to the micrometre.
/// @param box around the shape. @param cell of the lattice (m)
inline TriangleMesh polygonize(const Implicit& f, const Box& box, double cell) {
  const BccLattice lattice = BccLattice::around(box, cell);
  std::vector<double> value;
  for (std::int64_t p = 0; p < lattice.points(); ++p) value.push_back(f(lattice.position(p)));
  TriangleMesh mesh = boundarySurface(stuff(lattice, value, 0.0));
  for (int round = 0; round < 12; ++round) {
    std::vector<Vec3> sum(mesh.vertex.size(), Vec3::Zero());
    std::vector<double> count(mesh.vertex.size(), 0.0);
    for (const Index3& v : mesh.triangle) {
      for (int k = 0; k < 3; ++k) {
        sum[slot(v[k])] += mesh.vertex[slot(v[(k + 1) % 3])];
        count[slot(v[k])] += 1.0;
      }
    }
    for (std::size_t i = 0; i < mesh.vertex.size(); ++i) {
      mesh.vertex[i] = projected(f, 0.5 * mesh.vertex[i] + 0.5 * (sum[i] / count[i]));
    }
  }
  for (Vec3& p : mesh.vertex) {
    p = projected(f, projected(f, p));
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 1e6) / 1e6 + 0.0;
  }
  return mesh;
}

}  // namespace calot::organs

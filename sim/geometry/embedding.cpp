// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/surface_distance.h"
#include "sim/math/linear.h"

namespace calot {

namespace {

/// Tetrahedra by the cells of a uniform grid that their boxes cover.
class TetrahedronGrid {
 public:
  explicit TetrahedronGrid(const TetrahedralMesh& mesh) {
    Box all;
    for (const Vec3& p : mesh.vertex) all.include(p);
    lower_ = all.lower;
    const Vec3 size = all.upper - all.lower;
    // About one tetrahedron per cell.
    const double volume = std::max(size[0] * size[1] * size[2], 1e-30);
    cell_ = std::max(std::sqrt(std::sqrt(volume / static_cast<double>(mesh.tetrahedron.size()) * size.maxCoeff())),
                     size.maxCoeff() / 64.0);
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>(size[a] / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                  static_cast<std::size_t>(count_[2]));
    for (std::size_t t = 0; t < mesh.tetrahedron.size(); ++t) {
      Box box;
      for (int a = 0; a < 4; ++a) box.include(mesh.vertex[slot(mesh.tetrahedron[t][a])]);
      forEachIndex(cellOf(box.lower), cellOf(box.upper),
                   [&](const Index3& cell) { cells_[number(cell)].push_back(static_cast<int>(t)); });
    }
  }
  [[nodiscard]] const std::vector<int>& near(const Vec3& p) const { return cells_[number(cellOf(p))]; }

 private:
  [[nodiscard]] Index3 cellOf(const Vec3& p) const {
    Index3 c;
    for (int a = 0; a < 3; ++a) {
      c[a] = static_cast<int>(
          std::min(notNegative(std::floor((p[a] - lower_[a]) / cell_)), static_cast<double>(count_[a] - 1)));
    }
    return c;
  }
  [[nodiscard]] std::size_t number(const Index3& c) const {
    return slot(c[0]) + slot(count_[0]) * (slot(c[1]) + slot(count_[1]) * slot(c[2]));
  }
  Vec3 lower_;
  double cell_ = 0.0;
  Index3 count_ = Index3::Ones();
  std::vector<std::vector<int>> cells_;
};

std::array<double, 4> barycentric(const TetrahedralMesh& mesh, int tetrahedron, const Vec3& p) {
  const Index4& t = mesh.tetrahedron[slot(tetrahedron)];
  const Vec3& a = mesh.vertex[slot(t[0])];
  const Vec3 b = mesh.vertex[slot(t[1])] - a;
  const Vec3 c = mesh.vertex[slot(t[2])] - a;
  const Vec3 d = mesh.vertex[slot(t[3])] - a;
  const Vec3 x = p - a;
  const double volume = b.dot(c.cross(d));
  const double wb = x.dot(c.cross(d)) / volume;
  const double wc = b.dot(x.cross(d)) / volume;
  const double wd = b.dot(c.cross(x)) / volume;
  return {1.0 - ((wb + wc) + wd), wb, wc, wd};
}

}  // namespace

Embedding::Embedding(std::span<const Vec3> points, const TetrahedralMesh& mesh) {
  const TetrahedronGrid grid(mesh);
  const std::vector<BoundaryTriangle> boundary = boundaryTriangles(mesh);
  TriangleMesh surface;
  surface.vertex = mesh.vertex;
  for (const BoundaryTriangle& t : boundary) surface.triangle.push_back(t.vertex);
  const SurfaceDistance distance(std::move(surface), InsideRule::pseudonormal);
  anchor_.reserve(points.size());
  for (const Vec3& p : points) {
    int owner = -1;
    for (const int t : grid.near(p)) {
      const std::array<double, 4> w = barycentric(mesh, t, p);
      if (*std::min_element(w.begin(), w.end()) >= -1e-12) {
        owner = t;
        break;
      }
    }
    if (owner < 0) owner = boundary[slot(distance.closest(p).triangle)].tetrahedron;
    Anchor anchor;
    anchor.weight = barycentric(mesh, owner, p);
    for (std::size_t a = 0; a < 4; ++a) anchor.node[a] = mesh.tetrahedron[slot(owner)][static_cast<int>(a)];
    anchor_.push_back(anchor);
  }
}

void Embedding::map(std::span<const Vec3> nodes, std::vector<Vec3>& points) const {
  points.resize(anchor_.size());
  for (std::size_t i = 0; i < anchor_.size(); ++i) {
    const Anchor& a = anchor_[i];
    points[i] = ((a.weight[0] * nodes[slot(a.node[0])] + a.weight[1] * nodes[slot(a.node[1])]) +
                 a.weight[2] * nodes[slot(a.node[2])]) +
                a.weight[3] * nodes[slot(a.node[3])];
  }
}

}  // namespace calot

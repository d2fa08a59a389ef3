// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/math/linear.h"

namespace calot {

/// A fine surface embedded in a coarse tetrahedral mesh: each vertex is an affine combination of the corners of one
/// tetrahedron, x = sum_a w_a x_a with sum_a w_a = 1 (barycentric mapping). A vertex outside the mesh belongs to the
/// tetrahedron behind the nearest point of the mesh's boundary, so its weights may be negative or above one.
class Embedding {
 public:
  struct Anchor {
    std::array<int, 4> node{};
    std::array<double, 4> weight{};
  };

  /// @pre the mesh has tetrahedra, all of positive volume; the points are finite
  Embedding(std::span<const Vec3> points, const TetrahedralMesh& mesh);

  [[nodiscard]] const std::vector<Anchor>& anchors() const { return anchor_; }

  /// Maps the surface's points for these node positions.
  void map(std::span<const Vec3> nodes, std::vector<Vec3>& points) const;

 private:
  std::vector<Anchor> anchor_;
};

}  // namespace calot

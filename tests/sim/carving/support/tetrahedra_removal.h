// SPDX-License-Identifier: GPL-3.0-or-later
// The common way to carve, for comparison: a body of tetrahedra from which those that the tool meets are taken out.
#pragma once

#include <span>
#include <vector>

#include "sim/carving/carved_field.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::test {

class TetrahedraRemoval {
 public:
  /// Cubes of edge `cell` (m) cut into six tetrahedra each; those whose centroid is inside make the body.
  TetrahedraRemoval(const Box& box, double cell, bool (*inside)(const Vec3&));

  /// Takes out every tetrahedron whose centroid lies in the swept tool.
  void stroke(std::span<const SweptCapsule> tool);

  struct Quality {
    int tetrahedra = 0;
    int smallClusters = 0;  ///< parts, connected across faces, besides the largest
    int dangling = 0;       ///< tetrahedra that hang on one face, or on none
  };
  [[nodiscard]] Quality quality() const;
  /// The faces of what is left, each with corners of its own.
  [[nodiscard]] TriangleMesh faces() const;

 private:
  TetrahedralMesh mesh_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace calot::test

// SPDX-License-Identifier: GPL-3.0-or-later
// Strands over the whole bed where one organ lies on another.
#pragma once

#include <cstddef>
#include <string>

#include "sim/connective/connective_tissue.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_distance.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// An organ at rest as its bed sees it.
struct BedOrgan {
  const TriangleMesh& surface;  ///< closed, outward
  const TetrahedralMesh& mesh;  ///< of its solid
};

struct ConnectiveBed {
  std::vector<Strand> strands;
  std::vector<std::array<std::uint32_t, 2>> sheets;
  std::string error;  ///< one sentence where there is no bed

  [[nodiscard]] bool ok() const { return error.empty(); }
};

/// The bed: every triangle of the first organ's surface whose corners all lie within `reach` of the second organ.
std::vector<Index3> bedTriangles(const TriangleMesh& first, const SurfaceDistance& second, double reach);

/// Strands over the whole bed, as bedTriangles() finds it. Its
/// triangles are divided evenly, edge by n, with the least n that gives at least `leastStrands` strands: one at each
/// vertex, to the nearest point of the second organ. Each strand stands for a third of the area of the divided
/// triangles around it; neighbours along their edges are joined by sheets.
/// @pre both organs have triangles and tetrahedra of positive volume; reach > 0; leastStrands > 0
ConnectiveBed makeBed(const BedOrgan& first, const BedOrgan& second, double reach, std::size_t leastStrands);

}  // namespace calot

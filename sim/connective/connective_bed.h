// SPDX-License-Identifier: GPL-3.0-or-later
// Strands over the bed between two adjacent organs.
#pragma once

#include <cstddef>
#include <string>

#include "sim/connective/connective_tissue.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_distance.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// An organ in its reference configuration.
struct BedOrgan {
  const TriangleMesh& surface;  ///< closed, outward
  const TetrahedralMesh& mesh;  ///< of its solid
};

struct ConnectiveBed {
  std::vector<Strand> strands;
  std::vector<std::array<std::uint32_t, 2>> sheets;
  std::string error;  ///< one sentence if there is no bed

  [[nodiscard]] bool ok() const { return error.empty(); }
};

/// The bed: all triangles of the first organ's surface whose corners all lie within `reach` of the second organ.
std::vector<Index3> bedTriangles(const TriangleMesh& first, const SurfaceDistance& second, double reach);

/// Strands over the whole bed (bedTriangles()). Its triangles' edges are divided by the smallest n that gives at least
/// `minStrands` strands, one from each vertex to the nearest point of the second organ. Each strand represents a third
/// of the area of the subdivided triangles around it; sheets join neighbours along edges.
/// @pre both organs have triangles and tetrahedra of positive volume; reach > 0; minStrands > 0
ConnectiveBed makeBed(const BedOrgan& first, const BedOrgan& second, double reach, std::size_t minStrands);

}  // namespace calot

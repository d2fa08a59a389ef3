// SPDX-License-Identifier: GPL-3.0-or-later
// A tetrahedral mesh of a surface at a requested number of tetrahedra.
#pragma once

#include <string>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// What a mesh keeps of its surface, and what it loses.
struct StuffingReport {
  int requested = 0;
  int tetrahedra = 0;
  double surfaceVolume = 0.0;  ///< m^3
  double meshVolume = 0.0;     ///< m^3
  double volumeError = 0.0;    ///< |meshVolume - surfaceVolume| / surfaceVolume
  double countError = 0.0;     ///< |tetrahedra - requested| / requested
  double surfaceToMesh =
      0.0;  ///< largest distance from the surface's vertices and centroids to the mesh's boundary (m)
  double meshToSurface = 0.0;     ///< largest distance from the boundary's vertices and centroids to the surface (m)
  double dihedralMin = 0.0;       ///< rad
  double dihedralMax = 0.0;       ///< rad
  double lostArea = 0.0;          ///< share of the surface's area farther than `lostDistance` from the mesh's boundary
  double lostDistance = 0.0;      ///< m; half a cell
  int lostParts = 0;              ///< connected patches of that area
  Vec3 lostWhere = Vec3::Zero();  ///< the point of the surface that is farthest from the mesh (m)
  int lostComponents = 0;         ///< components of the surface that no part of the mesh follows
  int droppedPieces = 0;          ///< pieces of mesh that thin parts had cut off, and that were left out
  double droppedVolume = 0.0;     ///< their volume (m^3)
};

struct StuffedMesh {
  std::string error;         ///< empty: the mesh holds what was asked. Else one sentence that says what is wrong
  bool unusable = false;     ///< with an error: the surface itself is at fault (empty, open, not finite, ...)
  TetrahedralMesh mesh;      ///< with an error: empty, or the nearest that was found
  double cellSize = 0.0;     ///< of the lattice (m)
  double levelOffset = 0.0;  ///< the level set that was filled (m); positive: grown
  StuffingReport report;

  [[nodiscard]] bool ok() const { return error.empty(); }
};

/// Largest number of tetrahedra that may be asked for.
inline constexpr int largestTetrahedronCount = 2'000'000;

/// Chooses cell size and level-set offset together, so that the number of tetrahedra is within 15 % of the request
/// (5 % where the lattice allows) and the volume within 1 % of the surface's. Taking the level set as it is loses
/// volume at sharp rims and thin parts; the offset gives it back. Pieces that a thin part cuts off are left out, and
/// counted in the report.
/// @param surface closed, outward, manifold (surface_report.h); metres
/// @param tetrahedra at least 12, at most largestTetrahedronCount
[[nodiscard]] StuffedMesh stuffToCount(const TriangleMesh& surface, int tetrahedra);

}  // namespace calot

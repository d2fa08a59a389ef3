// SPDX-License-Identifier: GPL-3.0-or-later
// A tetrahedral mesh of a surface at a requested number of tetrahedra.
#pragma once

#include <string>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// Comparison of a mesh with its surface.
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
  int lostComponents = 0;         ///< components of the surface without a corresponding part of the mesh
  int droppedPieces = 0;          ///< pieces of mesh that thin parts separated and that were dropped
  double droppedVolume = 0.0;     ///< their volume (m^3)
};

struct StuffedMesh {
  std::string error;         ///< one sentence; empty: the mesh meets all requirements
  bool unusable = false;     ///< with an error: the surface itself is invalid (empty, open, not finite, ...)
  TetrahedralMesh mesh;      ///< with an error: empty, or the best that was found
  double cellSize = 0.0;     ///< of the lattice (m)
  double levelOffset = 0.0;  ///< level of the filled level set (m); positive: enlarged
  StuffingReport report;

  [[nodiscard]] bool ok() const { return error.empty(); }
};

/// Greatest number of tetrahedra that may be requested.
inline constexpr int maxTetrahedronCount = 2'000'000;

/// Chooses cell size and level-set offset together, so that the number of tetrahedra is within 15 % of the request (5
/// % where the lattice allows) and the volume within 1 % of the surface's. The unshifted level set loses volume at
/// sharp rims and thin parts; the offset compensates for it. Pieces that a thin part separates are dropped and
/// counted in the report.
/// @param surface closed, outward, manifold (surface_report.h); metres
/// @param tetrahedra at least 12, at most maxTetrahedronCount
[[nodiscard]] StuffedMesh stuffToCount(const TriangleMesh& surface, int tetrahedra);

}  // namespace calot

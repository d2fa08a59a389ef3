// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a surface from elsewhere, and what of it can be put right honestly.
#pragma once

#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// An honest account of a surface. Counts, not judgements: closedManifold() judges.
struct SurfaceReport {
  int vertices = 0;
  int triangles = 0;
  int unusedVertices = 0;       ///< in no triangle
  int coincidentVertices = 0;   ///< at exactly the place of an earlier one
  int degenerateTriangles = 0;  ///< a corner repeated, or height below 1e-10 of the longest side
  int duplicateTriangles = 0;   ///< the same three vertices as an earlier one, in any order
  int openEdges = 0;            ///< with one triangle
  int holes = 0;                ///< groups of open edges that hang together
  int nonManifoldEdges = 0;     ///< with more than two triangles
  int flippedEdges = 0;         ///< whose two triangles disagree on what is outside
  int components = 0;           ///< connected across edges
  int inwardComponents = 0;     ///< closed, consistent, and of negative volume though not a cavity of another
  int cavities = 0;             ///< closed, of negative volume, and inside another component: rightly so
  double area = 0.0;            ///< m^2
  double volume = 0.0;          ///< signed (m^3); of little meaning while there are holes or flipped edges
  Box box;                      ///< m

  /// No hole, every edge with two triangles that agree, every component outward (or a cavity).
  [[nodiscard]] bool closedManifold() const {
    return triangles > 0 && openEdges == 0 && nonManifoldEdges == 0 && flippedEdges == 0 && inwardComponents == 0;
  }
};

[[nodiscard]] SurfaceReport inspectSurface(const TriangleMesh& mesh);

/// What repairSurface did.
struct SurfaceRepair {
  TriangleMesh mesh;
  int weldedVertices = 0;     ///< made one with an earlier vertex at exactly the same place
  int droppedDegenerate = 0;  ///< triangles with a repeated corner after welding
  int droppedDuplicates = 0;
  int droppedVertices = 0;   ///< in no triangle
  int flippedTriangles = 0;  ///< turned to agree with their component, and the component outward

  [[nodiscard]] bool changed() const {
    return weldedVertices + droppedDegenerate + droppedDuplicates + droppedVertices + flippedTriangles > 0;
  }
};

/// Puts right what can be without inventing surface: welds vertices at exactly the same place, drops triangles with a
/// repeated corner, duplicates and unused vertices, turns triangles to agree with their neighbours, and turns closed
/// components outward (cavities inward). Holes and non-manifold edges stay; across the latter nothing is turned.
/// Triangles and vertices keep their order.
[[nodiscard]] SurfaceRepair repairSurface(const TriangleMesh& mesh);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Inspection of an imported surface, and repairs that invent nothing.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// Counts of a surface's properties; closedManifold() is the verdict.
struct SurfaceReport {
  int vertices = 0;
  int triangles = 0;
  int unusedVertices = 0;       ///< in no triangle
  int coincidentVertices = 0;   ///< at exactly the position of an earlier one
  int degenerateTriangles = 0;  ///< a corner repeated, or height below 1e-10 of the longest side
  int duplicateTriangles = 0;   ///< the same three vertices as an earlier one, in any order
  int openEdges = 0;            ///< with one triangle
  int holes = 0;                ///< connected groups of open edges
  int nonManifoldEdges = 0;     ///< with more than two triangles
  int flippedEdges = 0;         ///< whose two triangles disagree on what is outside
  int components = 0;           ///< connected across edges
  int inwardComponents = 0;     ///< closed, consistent, and of negative volume though not a cavity of another
  int cavities = 0;             ///< closed, of negative volume, and inside another component: correct
  double area = 0.0;            ///< m^2
  double volume = 0.0;          ///< signed (m^3); unreliable if there are holes or flipped edges
  Box box;                      ///< m

  /// No hole, every edge with two triangles that agree, every component outward (or a cavity).
  [[nodiscard]] bool closedManifold() const {
    return triangles > 0 && openEdges == 0 && nonManifoldEdges == 0 && flippedEdges == 0 && inwardComponents == 0;
  }
};

[[nodiscard]] SurfaceReport inspectSurface(const TriangleMesh& mesh);

/// Repairs that repairSurface() made.
struct SurfaceRepair {
  TriangleMesh mesh;
  int weldedVertices = 0;     ///< merged with an earlier vertex at exactly the same position
  int droppedDegenerate = 0;  ///< triangles with a repeated corner after welding
  int droppedDuplicates = 0;
  int droppedVertices = 0;   ///< in no triangle
  int flippedTriangles = 0;  ///< reversed to agree with their component, or to orient it outward

  [[nodiscard]] bool changed() const {
    return weldedVertices + droppedDegenerate + droppedDuplicates + droppedVertices + flippedTriangles > 0;
  }
};

/// Repairs what can be repaired without inventing surface: welds vertices at exactly the same position, drops triangles
/// with a repeated corner, duplicates and unused vertices, reverses triangles to agree with their neighbours, and
/// orients closed components outward (cavities inward). Holes and non-manifold edges remain; orientation does not
/// spread across the latter. Triangles and vertices keep their order.
[[nodiscard]] SurfaceRepair repairSurface(const TriangleMesh& mesh);

// Self-intersections of a surface.

struct SelfCrossing {
  std::size_t pairs = 0;  ///< pairs of triangles that cross; at most the limit
  int first = -1;         ///< the first such pair found, in the order of the sweep; -1: none
  int second = -1;
  Vec3 where = Vec3::Zero();  ///< of it, on both triangles (m)
};

/// Pairs of triangles of which an edge of one passes through the inside of the other, found by sweeping along the
/// longest axis of the bounds. Triangles that only touch (in a point, along an edge, coplanar) or share an edge do not
/// cross. Cost grows with the pairs whose bounds overlap along that axis.
/// @param maxPairs stop after this many pairs
/// @pre indices are in range, coordinates finite
[[nodiscard]] SelfCrossing findSelfCrossing(const TriangleMesh& mesh, std::size_t maxPairs = 1000);

// Holes of an imported surface: where they are, and triangles that close them.

/// A closed loop of open edges.
struct SurfaceHole {
  std::vector<int> vertex;     ///< in order, as triangles that fill it go round
  Vec3 centre = Vec3::Zero();  ///< mean of its vertices (m)
  double perimeter = 0.0;      ///< m
  double area = 0.0;           ///< of the triangles that fill it (m^2); 0: it was not filled
  std::string fault;           ///< why it was not filled; empty: it was, or nobody asked
};

/// Loops longer than this are not filled: the search for the best triangles grows with the cube of the edges.
inline constexpr int maxHoleEdges = 800;

/// Holes in the order of their smallest vertex. A loop that passes a vertex twice is divided there. Open edges that no
/// loop can be followed along (beside edges of more than two triangles, or where triangles disagree on what is outside)
/// are in no hole.
[[nodiscard]] std::vector<SurfaceHole> findHoles(const TriangleMesh& mesh);

struct HoleFilling {
  TriangleMesh mesh;               ///< triangles of the fillings follow those that were there
  std::vector<SurfaceHole> holes;  ///< as findHoles() has them, with area or fault
};

/// Fills holes without new vertices: of all triangulations of a loop the one whose sharpest edge, to its surroundings
/// and within, is the flattest; of equally flat ones the one of least area (Liepa, "Filling Holes in Meshes", 2003).
/// If each of them would need an edge that exists already, a vertex in the loop's centre is joined to all of
/// its edges. A filling is oriented like its surroundings; whether it crosses other parts of the surface is not
/// looked at (findSelfCrossing() does).
[[nodiscard]] HoleFilling fillHoles(const TriangleMesh& mesh);

}  // namespace calot

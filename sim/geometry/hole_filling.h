// SPDX-License-Identifier: GPL-3.0-or-later
// Holes of an imported surface: where they are, and triangles that close them.
#pragma once

#include <string>
#include <vector>

#include "sim/geometry/triangle_mesh.h"

namespace calot {

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
/// looked at (self_crossing.h does).
[[nodiscard]] HoleFilling fillHoles(const TriangleMesh& mesh);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedral meshes from signed distance: isosurface stuffing (Labelle and Shewchuk 2007, "Isosurface stuffing: fast
// tetrahedral meshes with good dihedral angles", ACM Transactions on Graphics 26(3)) on a body-centred cubic lattice.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/linear.h"

namespace calot {

/// Volume mesh. @pre everywhere: every tetrahedron (a, b, c, d) has (b - a) x (c - a) . (d - a) > 0.
struct TetrahedralMesh {
  std::vector<Vec3> vertex;         ///< m
  std::vector<Index4> tetrahedron;  ///< four indices into `vertex`
};

/// Sum of the tetrahedra's volumes (m^3).
[[nodiscard]] double meshVolume(const TetrahedralMesh& mesh);

struct DihedralRange {
  double min = 0.0;  ///< rad
  double max = 0.0;  ///< rad
};

/// Smallest and largest of all dihedral angles (rad); zeros for an empty mesh.
[[nodiscard]] DihedralRange dihedralRange(const TetrahedralMesh& mesh);

struct BoundaryTriangle {
  Index3 vertex = Index3::Zero();  ///< outward, the smallest index first
  int tetrahedron = 0;             ///< its only tetrahedron
};

/// Faces that belong to one tetrahedron, ordered by their vertex indices. Vertices keep their numbers.
[[nodiscard]] std::vector<BoundaryTriangle> boundaryTriangles(const TetrahedralMesh& mesh);

/// The boundary as a surface of its own, vertices renumbered in order of their old numbers.
[[nodiscard]] TriangleMesh boundarySurface(const TetrahedralMesh& mesh);

/// Connected components of tetrahedra through faces, numbered from 0 in order of their first tetrahedron.
[[nodiscard]] std::vector<int> tetrahedronComponents(const TetrahedralMesh& mesh, int& count);

/// The tetrahedra with keep[i] != 0, in order; vertices without a tetrahedron are dropped.
[[nodiscard]] TetrahedralMesh subMesh(const TetrahedralMesh& mesh, const std::vector<std::uint8_t>& keep);

/// Body-centred cubic lattice: a cubic grid of `size` points, origin + cell (i, j, k), and the centres of its cubes.
/// Long edges (length `cell`) join neighbours of one kind, short ones (sqrt(3)/2 cell) join the kinds.
struct BccLattice {
  Vec3 origin = Vec3::Zero();    ///< m
  double cell = 0.0;             ///< edge of a cube (m)
  Index3 size = Index3::Zero();  ///< corner points along each axis, at least 2 each

  /// Smallest lattice with a margin of at least one cell around the box. Its middle is the box's middle, so that a
  /// mirrored surface has a mirrored lattice. @pre cell > 0, the box not empty
  static BccLattice around(const Box& box, double cell);

  [[nodiscard]] std::int64_t corners() const;  ///< number of corner points
  [[nodiscard]] std::int64_t points() const;   ///< corners and centres
  /// Position of point p: corners first, i fastest, then centres likewise.
  [[nodiscard]] Vec3 position(std::int64_t p) const;
};

/// Distance of a cut from a lattice point, as a share of its edge, below which the point is moved onto the cut.
struct StuffingLimits {
  double longEdge = 0.285;  ///< these two give dihedral angles in [10.65, 164.70] degrees for all cuts
  double shortEdge = 0.40;
};

/// Position at which the surface crosses the edge from lattice point p to q, p < q, as a share from p in (0, 1). Called
/// only for edges whose ends lie on different sides; must be a pure function.
using CutShare = std::function<double(std::int64_t p, std::int64_t q)>;

/// Fills {value < level} with tetrahedra. Every vertex, cut and diagonal is a function of the lattice alone, so the
/// mesh has no cracks, and the same input gives the same bits everywhere. Vertices are ordered by lattice point and
/// edge, tetrahedra by lattice tetrahedron.
/// @param cut empty: values are linear along the edges
/// @param value one for each lattice point (m); outside on the lattice's outermost points, or the mesh is cut off there
[[nodiscard]] TetrahedralMesh stuff(const BccLattice& lattice, const std::vector<double>& value, double level,
                                    const StuffingLimits& limits = {}, const CutShare& cut = {});

}  // namespace calot

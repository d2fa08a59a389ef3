// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedral meshes from signed distance: isosurface stuffing (Labelle and Shewchuk 2007, "Isosurface stuffing: fast
// tetrahedral meshes with good dihedral angles", ACM Transactions on Graphics 26(3)) on a body-centred cubic lattice.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
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

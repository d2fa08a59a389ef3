// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance of lattice nodes to a triangle surface, exact in a band around it.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// Method by which inside and outside were distinguished.
enum class SignRule {
  pseudonormals,  ///< angle-weighted pseudonormals (Baerentzen and Aanaes 2005)
  regions,        ///< one winding number for each region that the surface does not cut
};

struct DistanceTransform {
  std::string error;          ///< one line of reason if there is no field, else empty
  std::vector<double> value;  ///< m, by BrickLattice::node(); negative inside, clamped to +-band
  double band = 0.0;          ///< m
  SignRule rule = SignRule::pseudonormals;
};

/// The closest point transform after Mauch (2003, "Efficient algorithms for solving static Hamilton-Jacobi equations",
/// part II): the nodes closest to a face lie in a prism on it, those closest to an edge in a wedge, those closest to a
/// vertex in a cone; each of these convex sets, cut off at the band, is scan-converted on the lattice, and a node takes
/// the smallest distance. Cost is linear in surface and band, plus one pass over the lattice.
///
/// The wedge of an edge is bounded by all of its faces, the cone of a vertex by the half-spaces of all its edges
/// (behind each of them), whatever their shape: this also holds at saddles. Sets are scanned slightly enlarged, and
/// every distance found is that to a point of the surface, so that no node of the band is missed or too low.
///
/// A closed surface with overlapping or crossing parts represents the union of what it winds around:
/// where pseudonormals contradict each other, one winding number per region between cuts gives the sign
/// (inside above one half).
///
/// Open surfaces (edges without a partner in the opposite direction) and surfaces that leave the lattice or are inside
/// out are refused with a reason.
///
/// @param mesh outward, m; coincident vertices are joined beforehand (repairSurface)
/// @param band in cells, greater than 1
/// @pre indices are in range
[[nodiscard]] DistanceTransform closestPointTransform(const TriangleMesh& mesh, const BrickLattice& lattice,
                                                      double band);

// Faces, edges and vertices of a surface with the normals that distances need.

/// Features of a mesh whose coordinates are given (any unit). Linear in its size.
class SurfaceFeatures {
 public:
  struct Face {
    Vec3 normal = Vec3::Zero();    ///< unit, outward; zero for a sliver (sine of its angle below 1e-10)
    std::array<Vec3, 3> inward{};  ///< unit, in the plane, across edge k to the inside; zero for a sliver
    [[nodiscard]] bool flat() const { return normal.squaredNorm() > 0.5; }
  };
  struct Edge {
    int low = 0;  ///< vertices, low < high
    int high = 0;
    int first = 0;  ///< sides [first, last)
    int last = 0;
    Vec3 normal = Vec3::Zero();  ///< sum of its faces' normals
  };
  struct Side {
    int triangle = 0;
    int side = 0;
    int low = 0;
    int high = 0;
    bool forward = false;  ///< runs from low to high
  };

  SurfaceFeatures(std::span<const Vec3> vertex, std::span<const Index3> triangle);

  [[nodiscard]] const std::vector<Face>& faces() const { return face_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edge_; }
  [[nodiscard]] std::span<const Side> sides(const Edge& edge) const {
    return std::span(side_).subspan(slot(edge.first), slot(edge.last - edge.first));
  }
  /// Edges that end at a vertex.
  [[nodiscard]] std::span<const int> edgesAt(int vertex) const {
    return std::span(around_).subspan(slot(aroundStart_[slot(vertex)]),
                                      slot(aroundStart_[slot(vertex) + 1] - aroundStart_[slot(vertex)]));
  }
  /// Angle-weighted sums of the faces' normals, one a vertex.
  [[nodiscard]] const std::vector<Vec3>& vertexNormals() const { return vertexNormal_; }
  /// Edges whose sides do not balance in both directions.
  [[nodiscard]] int openEdges() const { return openEdges_; }
  /// Every edge has exactly two sides, in opposite directions.
  [[nodiscard]] bool manifoldEdges() const { return manifold_; }

 private:
  void makeEdges(std::size_t vertices, std::span<const Index3> triangle);

  std::vector<Face> face_;
  std::vector<Edge> edge_;
  std::vector<Side> side_;
  std::vector<int> aroundStart_;
  std::vector<int> around_;
  std::vector<Vec3> vertexNormal_;
  int openEdges_ = 0;
  bool manifold_ = true;
};

// Signs of a distance field.

/// Gives nodes beyond the band (value = band, sign unknown) the sign of their surroundings; the
/// lattice's border is outside.
/// @param value in cells, distances within the band with their signs
/// @return false when signs contradict each other: two neighbours of unlike sign have a surface between them, so their
/// distances are at most one cell together. Only the magnitudes of values are then valid.
[[nodiscard]] bool spreadSigns(const BrickLattice& lattice, double band, std::vector<double>& value);

/// Recomputes all signs: neighbours whose distances add up to more than one cell have no surface between them and lie
/// in one region; one winding number per region decides, inside above one half.
/// @param mesh closed, m @param value in cells; only its magnitude is read
void signByRegions(const TriangleMesh& mesh, const BrickLattice& lattice, double band, std::vector<double>& value);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance of lattice nodes to a triangle surface, exact in a band around it.
#pragma once

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

}  // namespace calot

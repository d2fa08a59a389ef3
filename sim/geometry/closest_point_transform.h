// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance of lattice nodes to a triangle surface, exact in a band around it.
#pragma once

#include <string>
#include <vector>

#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// How inside was told from outside.
enum class SignRule {
  pseudonormals,  ///< angle-weighted pseudonormals (Baerentzen and Aanaes 2005)
  regions,        ///< one winding number for each region that the surface does not cut
};

struct DistanceTransform {
  std::string error;          ///< why there is no field, in one line; empty when there is one
  std::vector<double> value;  ///< m, by BrickLattice::node(); negative inside, clamped to +-band
  double band = 0.0;          ///< m
  SignRule rule = SignRule::pseudonormals;
};

/// The closest point transform after Mauch (2003, "Efficient algorithms for solving static Hamilton-Jacobi equations",
/// part II): the nodes closest to a face lie in a prism on it, those closest to an edge in a wedge, those closest to a
/// vertex in a cone; each of these convex sets, cut off at the band, is scan-converted on the lattice, and a node keeps
/// the least distance. Cost is linear in surface and band, plus one pass over the lattice.
///
/// The wedge of an edge is bounded by all of its faces, the cone of a vertex by the half-spaces of all its edges
/// (behind each of them), whatever their shape: that is right at saddles too. Sets are scanned a little wider than they
/// are and every distance found is that to a point of the surface, so no node of the band is missed or too low.
///
/// A closed surface with parts that overlap or cross is taken as the union of what it winds around: where pseudonormals
/// contradict each other, signs come from winding numbers above one half, one for each region between cuts.
///
/// Open surfaces (edges without a partner running the other way), surfaces that leave the lattice or turn inside out
/// are refused with a reason.
///
/// @param mesh outward, m; vertices at one place are joined beforehand (repairSurface)
/// @param band in cells, greater than 1
/// @pre indices are in range
[[nodiscard]] DistanceTransform closestPointTransform(const TriangleMesh& mesh, const BrickLattice& lattice,
                                                      double band);

}  // namespace calot

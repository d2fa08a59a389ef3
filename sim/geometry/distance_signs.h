// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes of a distance field are inside.
#pragma once

#include <vector>

#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

/// Gives the nodes beyond the band (value = band, without a sign of their own) the sign of their surroundings; the
/// lattice's border is outside.
/// @param value in cells, distances within the band with their signs
/// @return false when signs contradict each other: two neighbours of unlike sign have a surface between them, so their
/// distances are at most one cell together. Values are then of no use but for their size.
[[nodiscard]] bool spreadSigns(const BrickLattice& lattice, double band, std::vector<double>& value);

/// Gives all nodes signs anew: neighbours whose distances exceed one cell together have no surface between them and so
/// lie in one region; one winding number is asked for each region, above one half is inside.
/// @param mesh closed, m @param value in cells; only its size counts
void signByRegions(const TriangleMesh& mesh, const BrickLattice& lattice, double band, std::vector<double>& value);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// Signs of a distance field.
#pragma once

#include <vector>

#include "sim/geometry/brick_lattice.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot {

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

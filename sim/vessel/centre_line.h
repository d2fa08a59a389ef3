// SPDX-License-Identifier: GPL-3.0-or-later
// The centre line of a vessel between its nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// Side of the parting on which a point of a parted element lies.
enum class Stump : std::uint8_t { none, before, after };

/// Position and frame (z along the vessel towards its end, x and y across it) in W. In a whole element: a cubic
/// Hermite curve through the nodes, with their z axes times the chord's length as tangents, and blended frames; both
/// are free of kinks at nodes. In a parted element: the reference chord, fixed to the stump's node.
/// @pre where.element is of branch where.branch
Pose centreLine(const BeamModel& model, const BeamState& state, const BeamPoint& where, Stump stump = Stump::none);

/// Nodes that a point of the centre line depends on, with weights that sum to one.
struct BeamInfluence {
  std::array<int, 2> node{};
  std::array<double, 2> weight{};
  std::size_t count = 0;
};

/// A force on the wall acts on the centre line, distributed linearly over the element's nodes. Its moment about
/// the centre line (force times radius) is neglected: the surroundings constrain the vessel, and tools drag
/// rather than twist it.
BeamInfluence influenceOf(const BeamModel& model, const BeamPoint& where, Stump stump = Stump::none);

/// Side of the parting on which a point lies; none in a whole element.
Stump stumpAt(const BeamState& state, const BeamPoint& where);

}  // namespace calot

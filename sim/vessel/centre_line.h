// SPDX-License-Identifier: GPL-3.0-or-later
// The centre line of a vessel between its nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// On which side of a parting a place of a parted element is.
enum class Stump : std::uint8_t { none, before, after };

/// Place and frame (z along the vessel towards its end, x and y across it) in W.
/// In a whole element: cubic Hermite through the nodes with the nodes' own z axes as tangents, as long as the chord,
/// and the nodes' frames blended; so lines and frames have no kinks at nodes. In a parted element: the rest chord,
/// fixed to the node that the stump is left on. @param where.element is of branch where.branch
Pose centreLine(const BeamModel& model, const BeamState& state, const BeamPlace& where, Stump stump = Stump::none);

/// Nodes that a place of the centre line hangs on, with weights that sum to one.
struct BeamInfluence {
  std::array<int, 2> node{};
  std::array<double, 2> weight{};
  std::size_t count = 0;
};

/// A force on the wall acts on the centre line there: linear in the share. What it turns about the centre line (force
/// times radius) is neglected; the vessel is held by its surroundings, and tools drag rather than twist it.
BeamInfluence influenceOf(const BeamModel& model, const BeamPlace& where, Stump stump = Stump::none);

/// The side on which a place of a parted element is; none in a whole one.
Stump stumpAt(const BeamState& state, const BeamPlace& where);

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// What vessels carry where they are drawn: their stiffness in the reference configuration, and the loads of their
// elements there.
#pragma once

#include <span>

#include "sim/math/symmetric_blocks.h"
#include "sim/vessel/beam_model.h"

namespace calot {

/// Adds the stiffness of sim/vessel/beam_element.h in the reference configuration.
/// @param factor of all of it
/// @param row per node: the row of its place (N/m), followed by that of its rotation about W's axes (N m); -1: fixed
void addStiffness(const BeamModel& model, double factor, std::span<const int> row, SymmetricBlocks& matrix);

/// Loads each element as a motion from the reference configuration by these displacements (m) and rotations (rad)
/// would, to first order, without moving it: the configuration that is free of stress lies that far from where it is
/// drawn. The loads are measured in the elements' frames and turn with them.
/// @param displacement, rotation per node
void preload(BeamModel& model, std::span<const Vec3> displacement, std::span<const Vec3> rotation);

}  // namespace calot

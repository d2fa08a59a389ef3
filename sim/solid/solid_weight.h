// SPDX-License-Identifier: GPL-3.0-or-later
// The stiffness of solids and of springs in the reference configuration, in double, for systems that a Model solves
// once (sim/scene/weight_system.h).
#pragma once

#include <span>

#include "sim/math/symmetric_blocks.h"
#include "sim/solid/solid.h"

namespace calot {

/// Adds a solid's stiffness K (N/m) at rest.
/// @param fill remaining share of each cube; empty: all full
/// @param factor of all of it
/// @param row per node: its row of the matrix; -1: fixed
void addStiffness(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
                  SymmetricBlocks& matrix);

/// A material point and the rows of its solid's nodes.
struct PlacedPoint {
  const MaterialPoint& point;
  std::span<const int> row;
};

/// Adds a spring between two points that has the same stiffness in all directions (N/m).
void addSpring(const PlacedPoint& a, const PlacedPoint& b, double stiffness, SymmetricBlocks& matrix);

}  // namespace calot

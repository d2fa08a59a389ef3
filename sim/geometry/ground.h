// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

/// The surface on which falls what falls from a point.
struct Ground {
  double below = std::numeric_limits<double>::infinity();  ///< how far down (m)
  Vec3 normal = Vec3::Zero();                              ///< unit, upwards
};

/// The highest triangle below p, and not more than `above` above it, that faces up. Triangles that name no vertex are
/// passed over.
/// @param triangle counter-clockwise from outside @param down unit @param above m
[[nodiscard]] Ground groundBelow(const std::vector<Vec3>& position, const std::vector<Index3>& triangle, const Vec3& p,
                                 const Vec3& down, double above = 0.0);

}  // namespace calot

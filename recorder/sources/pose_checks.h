// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of poses in motion files.
#pragma once

#include <fmt/format.h>

#include "recorder/sources/pointing.h"
#include "sim/math/linear.h"

namespace calot::recorder {

/// @param fail throws with this fault @param hint on what may be wrong
inline void checkPosition(const Vec3& position, const char* hint, const auto& fail) {
  if (!(position.cwiseAbs().maxCoeff() <= maxPosition))
    fail(fmt::format("a position farther than {} m{}", maxPosition, hint));
}

inline Quat checkedRotation(const Mat3& matrix, const auto& fail) {
  const double off = rotationDefect(matrix);  // rounding in the format of kinematics is below 1e-4
  if (!(off <= rotationTolerance))
    fail(fmt::format("no rotation matrix (off by {:.2g}; {:.2g} is allowed)", off, rotationTolerance));
  return quaternionOf(matrix);
}

}  // namespace calot::recorder

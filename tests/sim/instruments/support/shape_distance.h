// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "sim/geometry/closest_point.h"
#include "sim/instruments/instrument_shape.h"

namespace calot::test {

/// The shape's implicit function at p (m) in the frame of its capsules: negative inside, 1e300 without capsules.
inline double distanceTo(const InstrumentShape& shape, const Vec3& p) {
  double least = 1e300;
  for (const Capsule& c : shape.capsules()) {
    const Vec3 q = c.p0 + closestOnSegment(p, c.p0, c.p1) * (c.p1 - c.p0);
    least = std::min(least, (p - q).norm() - c.radius);
  }
  return least;
}

}  // namespace calot::test

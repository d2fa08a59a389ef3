// SPDX-License-Identifier: GPL-3.0-or-later
// Z-width: the stiffest wall of a given damping and delay that a device shows without oscillating (Colgate and Brown
// 1994).
#pragma once

#include <cmath>

#include "tests/stability/closed_loop/support/closed_loop.h"

namespace calot::test {

struct WallRun {
  double swing = 0.0;      ///< m, over the last second of four
  double given = 0.0;      ///< J
  double maxShown = 0.0;   ///< N
  double stiffness = 0.0;  ///< N/m, of a slow press: mean force over mean depth, in the last second
};

/// The arm presses by 10 mm into a wall, from 5 mm before it, within 0.2 s, and stays there. A handle that nobody holds
/// is drawn there by half a newton, from outside.
inline WallRun pressWall(const LoopSettings& settings, double stiffness, double damping) {
  ClosedLoop loop(settings);
  VirtualWall wall(stiffness, damping);
  double force = 0.0, depth = 0.0;
  for (int k = 0; k < 4000; ++k) {
    if (k == 3000) loop.watch();
    const double way = std::min(1.0, k / 200.0);
    // The handle starts at 0; the wall begins 5 mm away.
    if (settings.hand.gripStiffness == 0.0) loop.hand().strike(Vec3(0.0005, 0.0, 0.0));
    const Vec3 wallAt(0.005, 0.0, 0.0);
    loop.tick(wall.force(loop.position() - wallAt), Vec3(0.015 * way, 0.0, 0.0));
    if (k >= 3000) {
      force += loop.shown().norm();
      depth += std::max(0.0, loop.hand().position().x() - 0.005);
    }
  }
  return {loop.swing(), loop.maxGiven, loop.maxShown, depth > 0.0 ? force / depth : 0.0};
}

inline constexpr double stillSwing = 0.0002;  ///< m, an order above what encoders of 10 um make of rest

/// Stiffest stable wall (N/m) up to `most`, to within 3 %.
inline double zWidth(const LoopSettings& settings, double damping, double most) {
  const auto stable = [&](double stiffness) { return pressWall(settings, stiffness, damping).swing < stillSwing; };
  if (stable(most)) return most;
  double low = 1.0, high = most;
  if (!stable(low)) return 0.0;
  while (high > 1.03 * low) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace calot::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "sim/scene/scene_view.h"

namespace calot {

/// SceneView::down of a scene with this gravity (m/s^2): its direction, or the view's default where there is none.
inline Vec3 downOf(const Vec3& gravity) {
  const double strength = gravity.norm();
  return std::isfinite(strength) && strength > 0.0 ? Vec3(gravity / strength) : SceneView().down;
}

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "recorder/sources/scene_surfaces.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// A point of an organ's surface that a hand can touch and the operator can see.
struct TouchTarget {
  std::size_t organ = 0;
  Vec3 point = Vec3::Zero();     ///< p_W (m)
  Vec3 normal = Vec3::UnitY();   ///< outward, unit
  Vec3 approach = Vec3::Zero();  ///< p_W from which the way to the point and the way back to the port are free (m)
};

/// All targets of a hand, by organ and then by triangle; one at the middle of each triangle where - the normal looks at
/// the camera and against the shaft, each by 20 degrees at least; - the point lies inside the picture and inside the
/// workspace, with 10 mm to spare; - from camera and from port the point is in sight: no organ is crossed on the way; -
/// the point `pullBack` nearer to the port is 5 mm clear of every organ.
std::vector<TouchTarget> touchTargets(const SceneDescription& scene, const SceneSurfaces& surfaces, std::size_t hand,
                                      double pullBack);

/// True when an instrument's tip can move from a to b in a straight line and stay `clearance` (m) off every organ.
bool isFree(const SceneSurfaces& surfaces, const Vec3& a, const Vec3& b, double clearance);

}  // namespace calot::recorder

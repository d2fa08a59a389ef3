// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/scene/description.h"

namespace calot::test {

/// Closed sphere surface, an icosahedron divided `levels` times (20 * 4^levels triangles), outward.
SurfaceDescription sphereSurface(const Vec3& centre, double radius, int levels);

/// Two round organs in front of a camera that looks along +z: a "liver" of radius 50 mm at z = 60 mm and a
/// "gallbladder" of 15 mm beside it; ports at left and right above, homes in the open.
SceneDescription roundScene();

}  // namespace calot::test

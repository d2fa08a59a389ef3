// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/base/identity.h"
#include "sim/math/linear.h"

namespace calot::recorder {

/// Where gravity pulls, by a scene file that another version's engine reads: its key "gravity" alone is looked at.
/// @return unit; SceneView's default where the file tells of none
[[nodiscard]] Vec3 downOf(const Asset& sceneFile);

}  // namespace calot::recorder

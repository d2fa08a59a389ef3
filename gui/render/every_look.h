// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A speck of everything that pictures show. Whoever draws it has shaders and textures before the first picture is
/// wanted.
[[nodiscard]] SceneView everyLook();

}  // namespace calot::gui

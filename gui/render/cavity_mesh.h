// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/draw_list.h"

namespace calot::gui {

/// The abdominal wall under pneumoperitoneum, as a gently uneven dome around organs and ports, seen from inside
/// (normals point inward). It depends on rest positions and ports alone, so it stands still while organs and camera
/// move.
[[nodiscard]] Mesh makeCavity(const SceneView& view);

}  // namespace calot::gui

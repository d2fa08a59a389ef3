// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A dome around organs and ports. It depends on rest positions and ports alone, so it stands still while
/// organs and camera move.
struct CavityShape {
  Vec3 centre = Vec3::Zero();  ///< p_W (m)
  double radius = 0.0;         ///< m
  bool operator==(const CavityShape&) const = default;
};
[[nodiscard]] CavityShape cavityShape(const SceneView& view);

/// The abdominal wall under pneumoperitoneum: the dome, gently uneven, seen from inside (normals point inward).
[[nodiscard]] Mesh makeCavity(const CavityShape& shape);

}  // namespace calot::gui

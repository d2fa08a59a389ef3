// SPDX-License-Identifier: GPL-3.0-or-later
// Blood or bile from a vessel that is parted and not closed: a visual hint, not a simulation. State contains neither
// fluids nor the time since parting; drop and stain depend on the view alone.
#pragma once

#include <vector>

#include "gui/render/mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// The face of a parted vessel that no clip closes.
struct OpenEnd {
  Vec3 position = Vec3::Zero();   ///< middle of the face in W (m)
  Vec3 outwards = Vec3::UnitZ();  ///< unit, away from the stump
  double radius = 0.0;            ///< of the face (m)
  Vec3 down = -Vec3::UnitZ();     ///< where it runs to, unit
  bool bile = false;              ///< leaves a cystic or bile duct; blood leaves any other vessel
};

/// All open faces, by SurfaceView::face. @pre checkView(view) has passed
[[nodiscard]] std::vector<OpenEnd> openEnds(const SceneView& view);

/// A drop that grows at the face for a few seconds, falls, and forms again. In the axes of W, about the middle of the
/// face.
/// @param time of the view (s)
[[nodiscard]] Mesh makeDrop(const OpenEnd& end, double time);

/// Stain at a point below the face, 0 to 1. What wells up runs down in waves.
/// @param p_W the point (m) @param time of the view (s)
[[nodiscard]] double stainAt(const OpenEnd& end, const Vec3& p_W, double time);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
// What lies around a scene without being of it: decoration, which stands still and touches nothing.
#pragma once

#include <vector>

#include "gui/render/cavity_mesh.h"
#include "gui/render/viscera_mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// Abdominal wall, and where the scene has bile duct or hepatic artery, and y is up, their ligament, omentum and bowel.
/// What was made for one view is kept as long as its organs at rest are the same.
class Surroundings {
 public:
  void update(const SceneView& view);

  [[nodiscard]] const Mesh& wall() const { return wall_; }
  [[nodiscard]] const Mesh& ligament() const { return ligament_; }
  [[nodiscard]] const Viscera& viscera() const { return viscera_; }

 private:
  CavityShape shape_;
  Mesh wall_;
  std::vector<Vec3> vessels_;  ///< of which the ligament was made
  Mesh ligament_;
  Viscera viscera_;
};

}  // namespace calot::gui

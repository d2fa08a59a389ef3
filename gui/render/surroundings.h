// SPDX-License-Identifier: GPL-3.0-or-later
// Decoration around a scene: static, without contact.
#pragma once

#include <span>
#include <vector>

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

/// Tissue below the liver in the field: the greater omentum, a fatty apron, and on it the hepatic flexure of the
/// colon and the duodenum. Decoration: it stands still, and instruments pass through it.
struct Viscera {
  Mesh omentum;  ///< open, seen from above (normals point up)
  Mesh bowel;    ///< two closed tubes
};

/// All of it lies below `lowest`, so that it hides nothing above that from an endoscope which is above that, too.
/// @param vessels points of the walls of bile duct and artery at rest (m), which say where the liver's hilum is; none:
/// empty meshes @param lowest height (y) of the lowest point that may not be hidden (m)
[[nodiscard]] Viscera makeViscera(std::span<const Vec3> vessels, double lowest);

/// Abdominal wall, and where the scene has bile duct or hepatic artery, and y is up, their ligament, omentum and bowel.
struct Surroundings {
  Mesh wall, ligament;
  Viscera viscera;

  /// Rebuilds the meshes where the view's organs at rest are others than before.
  void update(const SceneView& view);

 private:
  CavityShape shape_;
  std::vector<Vec3> vessels_;  ///< of which ligament and viscera were made
};

/// The hepatoduodenal ligament: the fold of peritoneum that bile duct and hepatic artery run along, from close behind
/// them down to the back of the cavity. Seen from above (normals point up). Decoration: it stands still, and
/// instruments pass through it.
/// @param vessels points of their walls at rest (m); none: an empty mesh
[[nodiscard]] Mesh makeLigament(std::span<const Vec3> vessels);

}  // namespace calot::gui

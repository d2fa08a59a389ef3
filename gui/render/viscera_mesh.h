// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "gui/render/mesh.h"

namespace calot::gui {

/// What lies below the liver in the field: the greater omentum, a fatty apron, and on it the hepatic flexure of the
/// colon and the duodenum. Decoration: it stands still, and instruments pass through it.
struct Viscera {
  Mesh omentum;  ///< open, seen from above (normals point up)
  Mesh bowel;    ///< two closed tubes
};

/// All of it lies below `lowest`, so that it hides nothing above that from an endoscope which is above that, too.
/// @param vessels points of the walls of bile duct and artery at rest (m), which say where the liver's hilum is; none:
/// empty meshes @param lowest height (y) of the lowest point that may not be hidden (m)
[[nodiscard]] Viscera makeViscera(std::span<const Vec3> vessels, double lowest);

}  // namespace calot::gui

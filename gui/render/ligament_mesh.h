// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "gui/render/mesh.h"

namespace calot::gui {

/// The hepatoduodenal ligament: the fold of peritoneum that bile duct and hepatic artery run along, from close behind
/// them down to the back of the cavity. Seen from above (normals point up). Decoration: it stands still, and
/// instruments pass through it.
/// @param vessels points of their walls at rest (m); none: an empty mesh
[[nodiscard]] Mesh makeLigament(std::span<const Vec3> vessels);

}  // namespace calot::gui

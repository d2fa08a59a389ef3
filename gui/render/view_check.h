// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "gui/render/translucent.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// Refuses views that cannot be drawn. @throws calot::Error as Renderer::render documents, naming surface and vertex.
void checkView(const SceneView& view);
/// @throws calot::Error (invalid)
void checkPictureSize(long long width, long long height);
/// @throws calot::Error (damaged) where a puff has a number that is not finite
void checkSmoke(std::span<const Puff> smoke);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "gui/render/graphics.h"

namespace calot::page {

/// A context whose functions are the host's: WebGL 2, under the names that OpenGL has for them.
[[nodiscard]] std::unique_ptr<gui::GraphicsContext> createWebContext();

}  // namespace calot::page

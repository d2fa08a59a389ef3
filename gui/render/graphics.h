// SPDX-License-Identifier: GPL-3.0-or-later
// Choice of the OpenGL implementation.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gui/render/graphics_context.h"

namespace calot::gui {

enum class Graphics {
  automatic,      ///< a graphics card where there is one that has what is needed, software else
  card,           ///< a graphics card, or an error
  software,       ///< Mesa's software rasterizer: the same bytes in every run
  deviceSoftware  ///< the same rasterizer on the way that cards are reached: to try that way without one
};

/// The words of the option `--graphics`, in the order of the enumeration: auto, card, software, egl-software.
[[nodiscard]] const std::vector<std::string>& graphicsWords();
/// @throws calot::Error (invalid) for another word
[[nodiscard]] Graphics graphicsFrom(std::string_view word);

/// @param graphics not automatic
/// @throws calot::Error (failure) where this machine has no such context
[[nodiscard]] std::unique_ptr<GraphicsContext> createContext(Graphics graphics);

}  // namespace calot::gui

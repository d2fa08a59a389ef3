// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gui/render/image.h"

namespace calot::gui {

/// Lays a colour over a pixel. Nothing happens outside of the picture. @param opacity 0 to 1
inline void blend(Image& image, int x, int y, const std::array<std::uint8_t, 3>& colour, double opacity) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || opacity <= 0.0) return;
  std::uint8_t* const pixel =
      image.rgba.data() +
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  for (std::size_t c = 0; c < 3; ++c) {
    const double before = pixel[c];
    pixel[c] = static_cast<std::uint8_t>(before + opacity * (colour[c] - before) + 0.5);
  }
  const double covered = pixel[3];
  pixel[3] = static_cast<std::uint8_t>(covered + opacity * (255.0 - covered) + 0.5);
}

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace calot::gui {

/// A picture: 8 bits a channel, red green blue alpha, sRGB, rows from top to bottom without padding. Alpha is straight
/// (colours are not multiplied by it).
struct Image {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<std::uint8_t> rgba;  ///< 4 width height bytes

  /// First of the four bytes of a pixel. @pre 0 <= x < width, 0 <= y < height
  [[nodiscard]] const std::uint8_t* pixel(int x, int y) const {
    return rgba.data() +
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 4;
  }
};

}  // namespace calot::gui

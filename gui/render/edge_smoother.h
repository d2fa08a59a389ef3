// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "gui/render/image.h"

namespace calot::gui {

/// Takes the steps off edges of a picture with one sample a pixel, on the processor: with a software rasterizer that
/// costs a tenth of a pass. Integers alone, so the bytes are the same everywhere. Keeps memory between pictures.
class EdgeSmoother {
 public:
  /// Only pixels at edges change. @pre the image has all its bytes
  void smooth(Image& image);

 private:
  void readBrightness(const Image& image);
  /// Blends the pixel with its neighbour across the edge, if the edge has a step near it.
  void smoothPixel(const Image& image, std::size_t at, std::ptrdiff_t x, std::ptrdiff_t y);
  [[nodiscard]] int brightness(std::size_t at, std::ptrdiff_t offset) const {
    return brightness_[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + offset)];
  }

  std::vector<std::uint8_t> brightness_;                        ///< of each pixel
  std::vector<std::uint8_t> isEdge_;                            ///< of the pixels of a row
  std::vector<std::pair<std::size_t, std::uint32_t>> changed_;  ///< pixels and their new colour
};

}  // namespace calot::gui

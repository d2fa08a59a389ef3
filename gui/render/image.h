// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
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

/// The bytes of a PNG (8-bit RGBA, sRGB chunk, no time stamp: equal images give equal bytes).
/// @throws calot::Error (failure) for an image whose size does not fit its bytes
std::string pngBytes(const Image& image);

/// Writes an image as PNG. Writes to a temporary name beside the file and renames; an existing file is replaced.
/// @throws calot::Error naming the file: as recorder::refuseOutput(), or (failure) if it cannot be written.
void writePng(const Image& image, const std::string& file);

/// How large a picture is asked for.
struct PictureSize {
  int width = 1280;  ///< pixels
  int height = 720;  ///< pixels
};
/// "1280x720"; none for anything else.
[[nodiscard]] std::optional<PictureSize> readSize(const std::string& text);
/// The same. @throws calot::Error (invalid) where there is none, or for a size outside the renderer's limits.
[[nodiscard]] PictureSize parsePictureSize(const std::string& text);

}  // namespace calot::gui

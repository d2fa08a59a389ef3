// SPDX-License-Identifier: GPL-3.0-or-later
// Words in pictures, by FreeType.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "gui/render/image.h"

namespace calot::gui {

using Colour = std::array<std::uint8_t, 3>;

/// Anchor of a line of text.
enum class Anchor { left, middle, right };

/// Writes lines of words (UTF-8) in one font and size, with a dark edge that keeps them readable on tissue.
class Lettering {
 public:
  /// @param pixels height of a line, at least 6
  /// @throws calot::Error (failure) where the font (DejaVu Sans, package fonts-dejavu-core) is not there
  explicit Lettering(int pixels);
  ~Lettering();
  Lettering(const Lettering&) = delete;
  Lettering& operator=(const Lettering&) = delete;

  [[nodiscard]] int lineHeight() const;
  [[nodiscard]] int widthOf(const std::string& text) const;
  /// @param x, y the anchor (pixels): of the line's left, middle or right end, and of its top. What leaves the picture
  /// is cut off. @param opacity 0 to 1
  void write(Image& image, const std::string& text, int x, int y, Anchor anchor, const Colour& colour,
             double opacity = 1.0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "gui/render/image.h"

namespace calot::gui {

/// Writes an image as PNG (8-bit RGBA, sRGB chunk, no time stamp: equal images give equal files). Writes to a temporary
/// name beside the file and renames; an existing file is replaced.
/// @throws calot::Error (failure) naming the file if it cannot be written.
void writePng(const Image& image, const std::filesystem::path& file);

/// How large a picture is asked for.
struct PictureSize {
  int width = 1280;  ///< pixels
  int height = 720;  ///< pixels
};
/// "1280x720". @throws calot::Error (invalid) for anything else, or for a size outside the renderer's limits.
[[nodiscard]] PictureSize parsePictureSize(const std::string& text);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "gui/render/image.h"

namespace calot::gui {

/// Writes an image as PNG (8-bit RGBA, sRGB chunk, no time stamp: equal images give equal files). Writes to a temporary
/// name beside the file and renames; an existing file is replaced.
/// @throws calot::Error (failure) naming the file if it cannot be written.
void writePng(const Image& image, const std::filesystem::path& file);

}  // namespace calot::gui

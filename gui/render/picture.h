// SPDX-License-Identifier: GPL-3.0-or-later
// How large a picture is asked for.
#pragma once

#include <string>

namespace calot::gui {

struct PictureSize {
  int width = 1280;  ///< pixels
  int height = 720;  ///< pixels
};

/// "1280x720". @throws calot::Error (invalid) for anything else, or for a size outside the renderer's limits.
[[nodiscard]] PictureSize parsePictureSize(const std::string& text);

}  // namespace calot::gui

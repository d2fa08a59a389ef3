// SPDX-License-Identifier: GPL-3.0-or-later
// A scene view to a PNG file: what the render command needs.
#pragma once

#include <filesystem>
#include <string>

#include "gui/render/renderer.h"

namespace calot::gui {

struct PictureSize {
  int width = 1280;  ///< pixels
  int height = 720;  ///< pixels
};

/// "1280x720". @throws calot::Error (usage) for anything else, or for a size outside the renderer's limits.
[[nodiscard]] PictureSize parsePictureSize(const std::string& text);

/// Renders and writes in one go. Nothing is left behind on failure: the file appears under its name when it is whole.
/// @throws calot::Error as Renderer::render and writePng do.
void writePicture(const SceneView& view, PictureSize size, const std::filesystem::path& file,
                  const RenderSettings& settings = {});

}  // namespace calot::gui

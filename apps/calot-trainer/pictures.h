// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "gui/trainer/trainer_window.h"

namespace calot::apps {

/// Writes a picture of each page into a folder: greeting.png and, with a scene, controls.png, running.png, paused.png
/// (after the first mistake, or a minute) and end.png. Lives in real time; what it records lies in the setup's folder.
/// @throws Error (failure) where nothing comes on the screen, or a picture cannot be written
void takePictures(gui::TrainerWindow& window, std::optional<recorder::LoadedScene> scene, const std::string& folder);

}  // namespace calot::apps

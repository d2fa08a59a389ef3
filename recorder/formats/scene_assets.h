// SPDX-License-Identifier: GPL-3.0-or-later
// A scene from the bytes of its file and of what that names; no file is touched. What is in them:
// docs/reference/scenes.md.
#pragma once

#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/formats/scene_surface.h"
#include "sim/math/linear.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// A scene with all its assets.
struct LoadedScene {
  SceneDescription description;       ///< what a Model is built from
  std::string summary;                ///< one sentence for people
  std::vector<std::string> warnings;  ///< repairs of surfaces, one line each
  std::vector<Asset>
      assets;  ///< the scene file first, then each mesh in the order of the organs and the fat; bytes as read
};

/// Reads a scene's description and its surfaces. @param fetch gives what it names @throws Error (damaged), naming file
/// and JSON pointer, where anything is unknown, missing or out of its range
LoadedScene parseScene(const Asset& file, const FetchAsset& fetch);

/// The same of a recording's assets: the first one is the scene file, the others are looked up by name.
/// @throws Error (damaged) as parseScene, and where a named asset is missing, double, or named by nobody.
LoadedScene sceneFromAssets(std::vector<Asset> assets);

/// Direction of gravity in a scene file that another version's engine reads: its key "gravity" alone is read.
/// @return unit; SceneView's default where the file has none
[[nodiscard]] Vec3 downOf(const Asset& sceneFile);

}  // namespace calot::recorder

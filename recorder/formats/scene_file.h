// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files: strict JSON, published as schemas/scene.schema.json and explained in docs/reference/scenes.md. Lengths
// in metres, everything in SI, in the frame W of docs/explanation/organs.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recorder/formats/scene_assets.h"

namespace calot::recorder {

/// Reads a scene file and the meshes that it names.
///
/// Names in the file are relative to the assets root: the folder above when the file lies in a folder `scenes`, else
/// the file's own folder. Nothing outside the root is read.
///
/// @throws Error (damaged), naming file and JSON pointer, where anything is unknown, missing or out of its range.
LoadedScene loadScene(const std::filesystem::path& sceneFile);

/// The file of a scene: a name such as "touch-liver", looked for as `scenes/<name>.json` under the roots in turn; or,
/// where it ends in ".json", the path of a scene file itself.
/// @throws Error (invalid) where there is none, with the names that there are.
std::filesystem::path findScene(const std::string& name, const std::vector<std::filesystem::path>& roots);

/// Every scene file under the roots, by name, the first root winning.
std::vector<std::filesystem::path> listScenes(const std::vector<std::filesystem::path>& roots);

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files: strict JSON, published as schemas/scene.schema.json and explained in docs/reference/scenes.md. Lengths
// in metres, everything in SI, in the frame W of docs/explanation/organs.md. A scene is also looked at as a whole: all
// faults at once, what catches nothing, and what contact costs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
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

/// Cost of an organ's surface, as far as its resolution decides.
struct ContactCost {
  std::string organ;
  std::size_t triangles = 0;
  std::size_t tetrahedra = 0;
  double meanEdge = 0.0;  ///< of the surface's triangles (m)
  double cellSize = 0.0;  ///< of the tetrahedra (m)
  /// Triangles whose edges are a third of a cell: finer ones show no more of how the organ deforms.
  std::size_t sensibleTriangles = 0;

  /// Is the surface so fine that preparing and drawing take several times what they need?
  [[nodiscard]] bool isFine() const;
};

struct SceneCheck {
  std::string scene;               ///< its name, or empty
  std::vector<Error> faults;       ///< it cannot be simulated; the tables that depend on faulty ones were not read
  std::vector<std::string> notes;  ///< it can, but probably not as meant: "/organs/0/anchors/1: ..."
  std::vector<ContactCost> costs;  ///< by organ; none where there are faults
};

/// Reads and builds a scene. Anchors and attachments that catch nothing, bodies that nothing holds, and surfaces that
/// are needlessly fine are notes. @throws Error (damaged) only where the file itself cannot be read as JSON
SceneCheck checkScene(const std::filesystem::path& sceneFile);

}  // namespace calot::recorder

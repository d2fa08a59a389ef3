// SPDX-License-Identifier: GPL-3.0-or-later
// A scene to begin with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace calot::apps {

struct SceneTemplate {
  std::string surface, unit, output;
  int tetrahedra = 1000;
  bool force = false;
};

/// Writes a scene file of one organ in the middle of the workspace, held on its side away from the endoscope, with two
/// graspers, and copies the surface beside it. The surface is placed by the scene's translation; its file stays as it
/// is. @return the files. @throws Error where the surface is open or of no organ's size, or something is there
std::vector<std::filesystem::path> writeSceneTemplate(const SceneTemplate& wanted);

}  // namespace calot::apps

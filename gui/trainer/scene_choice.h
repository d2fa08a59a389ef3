// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace calot::gui {

/// A scene that can be chosen.
struct SceneChoice {
  std::string name;
  std::string summary;  ///< one line
  std::filesystem::path file;
  std::string title = {};              ///< of the course's task on this scene; empty: it is in no course
  std::string goal = {};               ///< likewise
  std::filesystem::path picture = {};  ///< a small one; empty: none
};

/// Every scene under the roots that can be read: the course's tasks in its order, the easiest first; then the others
/// by name.
/// @param faults of those that cannot, one line each
[[nodiscard]] std::vector<SceneChoice> sceneChoices(const std::vector<std::filesystem::path>& roots,
                                                    std::vector<std::string>& faults);

}  // namespace calot::gui

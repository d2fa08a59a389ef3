// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that can be chosen, in the order of the course (assets/curricula).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/assessment/course.h"

namespace calot::gui {

/// The course "basic" of the first root that has it; empty where none has.
/// @throws Error as analytics::readCourse()
analytics::Course findCourse(const std::vector<std::filesystem::path>& roots);

/// The small picture of a scene beside the course: `curricula/pictures/SCENE.png` of the first root that has it, or
/// empty.
std::filesystem::path scenePicture(const std::string& scene, const std::vector<std::filesystem::path>& roots);

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

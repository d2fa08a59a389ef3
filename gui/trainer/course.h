// SPDX-License-Identifier: GPL-3.0-or-later
// A course: tasks of rising difficulty, each on a scene (assets/curricula/*.json, schemas/course.schema.json).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/math/record.h"

namespace calot::gui {

struct CourseTask {
  std::string scene;  ///< name of the scene
  std::string title;  ///< "Clip and cut"
  std::string goal;   ///< one sentence: what is to be reached

  static std::vector<Field> fields();
};

struct Course {
  std::string name, title;
  std::vector<CourseTask> tasks;  ///< the easiest first

  static std::vector<Field> fields();
};

/// @throws Error (damaged), naming file and JSON pointer, where anything is unknown, missing or out of its range.
Course readCourse(const std::filesystem::path& file);

/// The course "basic" of the first root that has it; empty where none has.
/// @throws Error as readCourse
Course findCourse(const std::vector<std::filesystem::path>& roots);

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

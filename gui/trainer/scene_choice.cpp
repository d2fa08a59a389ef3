// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scene_choice.h"

#include <algorithm>

#include "gui/trainer/course.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"

namespace calot::gui {

std::vector<SceneChoice> sceneChoices(const std::vector<std::filesystem::path>& roots,
                                      std::vector<std::string>& faults) {
  std::vector<SceneChoice> out;
  for (const std::filesystem::path& file : recorder::listScenes(roots)) {
    try {
      const recorder::LoadedScene scene = recorder::loadScene(file);
      out.push_back({scene.description.name, scene.summary, file});
      out.back().picture = scenePicture(scene.description.name, roots);
    } catch (const Error& fault) {
      faults.emplace_back(problemText(fault));
    }
  }
  Course course;
  try {
    course = findCourse(roots);
  } catch (const Error& fault) {
    faults.emplace_back(problemText(fault));
  }
  auto next = out.begin();
  for (const CourseTask& task : course.tasks) {
    const auto at = std::find_if(next, out.end(), [&](const SceneChoice& scene) { return scene.name == task.scene; });
    if (at == out.end()) continue;
    at->title = task.title;
    at->goal = task.goal;
    std::rotate(next, at, at + 1);
    ++next;
  }
  return out;
}

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scene_choices.h"

#include <algorithm>
#include <system_error>

#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"

namespace calot::gui {
namespace {

/// The first of these files that is there, or empty.
std::filesystem::path firstUnder(const std::vector<std::filesystem::path>& roots, const std::filesystem::path& name) {
  std::error_code ignored;
  for (const std::filesystem::path& root : roots) {
    if (std::filesystem::is_regular_file(root / name, ignored)) return root / name;
  }
  return {};
}

}  // namespace

analytics::Course findCourse(const std::vector<std::filesystem::path>& roots) {
  const std::filesystem::path file = firstUnder(roots, "curricula/basic.json");
  return file.empty() ? analytics::Course{} : analytics::readCourse(file);
}

std::filesystem::path scenePicture(const std::string& scene, const std::vector<std::filesystem::path>& roots) {
  return firstUnder(roots, std::filesystem::path("curricula/pictures") / (scene + ".png"));
}

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
  analytics::Course course;
  try {
    course = findCourse(roots);
  } catch (const Error& fault) {
    faults.emplace_back(problemText(fault));
  }
  auto next = out.begin();
  for (const analytics::CourseTask& task : course.tasks) {
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

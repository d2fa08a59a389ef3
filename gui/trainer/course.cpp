// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/course.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
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

std::vector<Field> CourseTask::fields() {
  using S = CourseTask;
  return {
      object("task", "Task on a scene"),
      {"scene", at<S, &S::scene>, TextRule{60}, "Name of a scene (calot scenes)"},
      {"title", at<S, &S::title>, TextRule{80}, "A word or a few: Clip and cut"},
      {"goal", at<S, &S::goal>, TextRule{300}, "One sentence: what is to be reached"},
  };
}

std::vector<Field> Course::fields() {
  using S = Course;
  return {
      object("", "Tasks of rising difficulty for the trainer"),
      fileFormat("calot-course"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, TextRule{60}, "Name of the course"},
      {"title", at<S, &S::title>, TextRule{80}, "One line"},
      Field("tasks", at<S, &S::tasks>, "The easiest first; no scene twice").items(1, 50),
  };
}

Course readCourse(const std::filesystem::path& file) {
  const nlohmann::json json =
      recorder::parseStrictJson(recorder::readFileBytes(file, file.string(), 1U << 16U), file.string());
  const recorder::JsonPlace root(json, file.string());
  Course course;
  recorder::readRecord(root, course);
  std::set<std::string> scenes;
  for (std::size_t i = 0; i < course.tasks.size(); ++i) {
    if (!scenes.insert(course.tasks[i].scene).second)
      root.at("tasks").at(i).at("scene").fail("an earlier task has this scene");
  }
  return course;
}

Course findCourse(const std::vector<std::filesystem::path>& roots) {
  const std::filesystem::path file = firstUnder(roots, "curricula/basic.json");
  return file.empty() ? Course{} : readCourse(file);
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

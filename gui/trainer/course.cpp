// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/course.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/formats/scene_file.h"

namespace calot::gui {
namespace {

using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::ObjectRule;

constexpr std::size_t maxCourseBytes = 1U << 16U;
constexpr std::size_t maxTasks = 50, maxName = 60, maxTitle = 80, maxGoal = 300;

/// The first of these files that is there, or empty.
std::filesystem::path firstUnder(const std::vector<std::filesystem::path>& roots, const std::filesystem::path& name) {
  std::error_code ignored;
  for (const std::filesystem::path& root : roots) {
    if (std::filesystem::is_regular_file(root / name, ignored)) return root / name;
  }
  return {};
}

}  // namespace

const std::vector<ObjectRule>& courseRules() {
  static const std::vector<ObjectRule> rules{
      {"", {{"format"}, {"formatVersion", true, 1, 1}, {"name"}, {"title"}, {"tasks"}}},
      {"task", {{"scene"}, {"title"}, {"goal"}}}};
  return rules;
}

Course readCourse(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = recorder::readFileBytes(file, file.string(), maxCourseBytes);
  const nlohmann::json json = recorder::parseStrictJson(bytes, file.string());
  const JsonPlace top(json, file.string());
  const JsonObject o = top.object(courseRules()[0]);
  static_cast<void>(o.at("format").word<bool>({{"calot-course", true}}));
  std::uint32_t version = 0;
  o.read("formatVersion", version);
  Course course;
  o.read("name", course.name, maxName);
  o.read("title", course.title, maxTitle);
  std::set<std::string> scenes;
  for (const JsonPlace& place : o.at("tasks").list(1, maxTasks)) {
    const JsonObject t = place.object(courseRules()[1]);
    CourseTask& task = course.tasks.emplace_back();
    t.read("scene", task.scene, maxName);
    t.read("title", task.title, maxTitle);
    t.read("goal", task.goal, maxGoal);
    if (!scenes.insert(task.scene).second) t.at("scene").fail("an earlier task has this scene");
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/course.h"

#include <gtest/gtest.h>

#include <fstream>

#include "recorder/base/errors.h"
#include "tests/analytics/assessment/support/texts.h"
#include "tests/recorder/support/small_scene.h"
#include "tests/support/fault.h"

namespace calot::gui {
namespace {

const std::vector<std::filesystem::path> assets{CALOT_SOURCE_DIR "/assets"};

TEST(Course, LeadsFromTheFirstTouchToTheWholeOperation) {
  const Course course = findCourse(assets);
  ASSERT_EQ(course.tasks.size(), 5U);
  EXPECT_EQ(course.tasks.front().scene, "touch-liver");
  EXPECT_EQ(course.tasks.back().scene, "cholecystectomy");
  for (const CourseTask& task : course.tasks) EXPECT_FALSE(scenePicture(task.scene, assets).empty()) << task.scene;
}

TEST(Course, OrdersTheScenes) {
  std::vector<std::string> faults;
  const std::vector<SceneChoice> scenes = sceneChoices(assets, faults);
  EXPECT_TRUE(faults.empty());
  const Course course = findCourse(assets);
  ASSERT_GE(scenes.size(), course.tasks.size());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const bool inCourse = i < course.tasks.size();
    EXPECT_EQ(scenes[i].title.empty(), !inCourse);
    if (inCourse) {
      EXPECT_EQ(scenes[i].name, course.tasks[i].scene);
      EXPECT_EQ(scenes[i].goal, course.tasks[i].goal);
    }
  }
}

TEST(Course, AnyOtherFolderOfAssetsHasNone) {
  EXPECT_TRUE(findCourse({"/nowhere"}).tasks.empty());
  EXPECT_TRUE(scenePicture("touch-liver", {"/nowhere"}).empty());
}

TEST(Course, WhatIsWrongIsNamedWithItsPlace) {
  const recorder::test::Folder folder;
  const auto faultOf = [&](const std::string& tasks) {
    std::ofstream(folder / "c.json") << R"({"format": "calot-course", "formatVersion": 1, "name": "c", "title": "C", )"
                                     << R"("tasks": )" << tasks << "}";
    return caught([&] { static_cast<void>(readCourse(folder / "c.json")); });
  };
  const std::string task = R"({"scene": "a", "title": "A", "goal": "Do."})";
  EXPECT_FALSE(faultOf("[" + task + "]"));
  const std::string file = (folder / "c.json").string();
  expectFault(ErrorKind::damaged, file + ": /tasks", {"0"}, faultOf("[]"));
  expectFault(ErrorKind::damaged, file + ": /tasks/0", {"\"goal\""}, faultOf(R"([{"scene": "a", "title": "A"}])"));
  // Two tasks of one scene: which is next?
  expectFault(ErrorKind::damaged, file + ": /tasks/1/scene", {}, faultOf("[" + task + ", " + task + "]"));
}

}  // namespace
}  // namespace calot::gui

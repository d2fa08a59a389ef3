// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scene_choices.h"

#include <gtest/gtest.h>

namespace calot::gui {
namespace {

const std::vector<std::filesystem::path> assets{CALOT_SOURCE_DIR "/assets"};

TEST(SceneChoices, LeadsFromTheFirstTouchToTheWholeOperation) {
  const analytics::Course course = findCourse(assets);
  ASSERT_EQ(course.tasks.size(), 5U);
  EXPECT_EQ(course.tasks.front().scene, "touch-liver");
  EXPECT_EQ(course.tasks.back().scene, "cholecystectomy");
  for (const analytics::CourseTask& task : course.tasks)
    EXPECT_FALSE(scenePicture(task.scene, assets).empty()) << task.scene;
}

TEST(SceneChoices, OrdersTheScenes) {
  std::vector<std::string> faults;
  const std::vector<SceneChoice> scenes = sceneChoices(assets, faults);
  EXPECT_TRUE(faults.empty());
  const analytics::Course course = findCourse(assets);
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

TEST(SceneChoices, AnyOtherFolderOfAssetsHasNone) {
  EXPECT_TRUE(findCourse({"/nowhere"}).tasks.empty());
  EXPECT_TRUE(scenePicture("touch-liver", {"/nowhere"}).empty());
}

}  // namespace
}  // namespace calot::gui

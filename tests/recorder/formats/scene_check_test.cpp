// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/geometry/triangle_mesh.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class SceneCheckTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("calot-scene-check-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_ / "scenes");
    fs::copy(fs::path(CALOT_SOURCE_DIR) / "assets" / "organs", folder_ / "organs", fs::copy_options::recursive);
    std::ifstream(fs::path(CALOT_SOURCE_DIR) / "assets" / "scenes" / "touch-liver.json") >> scene_;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write() const {
    const fs::path file = folder_ / "scenes" / "touch-liver.json";
    std::ofstream(file) << scene_;
    return file;
  }
  SceneCheck check() const { return checkScene(write()); }

  fs::path folder_;
  json scene_;
};

TEST_F(SceneCheckTest, AScenesFaultsAreAllSaid) {
  scene_["gravty"] = scene_["gravity"];
  scene_["timeLimit"] = -1;
  scene_["hands"]["left"]["instrument"] = "graspre";
  scene_["hands"]["right"].erase("port");
  scene_["camera"]["verticalFieldOfView"] = "wide";
  scene_["organs"][0]["material"]["poissonRatio"] = 0.5;
  scene_["organs"][0]["material"]["density"] = 1;
  scene_["organs"][1]["mesh"]["file"] = "organs/none.obj";
  scene_["organs"][1]["anchors"][0]["nearOrgan"]["distance"] = -1;
  scene_["solver"] = {{"iterations", 0.5}};
  const SceneCheck found = check();
  for (const char* place :
       {"/gravty", "/timeLimit", "/hands/left/instrument", "/hands/right", "/camera/verticalFieldOfView",
        "/organs/0/material/poissonRatio", "/organs/0/material/density", "/organs/1/mesh/file",
        "/organs/1/anchors/0/nearOrgan/distance", "/solver/iterations"}) {
    EXPECT_EQ(std::count_if(found.faults.begin(), found.faults.end(),
                            [&](const Error& e) { return e.where().place == place; }),
              1)
        << place;
  }
  EXPECT_EQ(found.faults.size(), 10U);
  EXPECT_TRUE(found.costs.empty());
  expectNames(found.faults.front().fault(), {"\"gravity\""});
  // Whoever simulates it gets one.
  EXPECT_THROW(loadScene(write()), Error);
}

TEST_F(SceneCheckTest, ScenesOfTheProgramHaveNone) {
  const SceneCheck found = check();
  EXPECT_TRUE(found.faults.empty());
  EXPECT_TRUE(found.notes.empty()) << found.notes.front();
  ASSERT_EQ(found.costs.size(), 2U);
  EXPECT_EQ(found.costs[0].organ, "liver");
  EXPECT_EQ(found.costs[0].triangles, 7250U);
  EXPECT_FALSE(found.costs[0].isFine());
}

TEST_F(SceneCheckTest, AnAnchorThatCatchesNothingIsNoted) {
  scene_["organs"][0]["anchors"].push_back({{"sphere", {{"centre", {0.5, 0.5, 0.5}}, {"radius", 0.01}}}});
  const SceneCheck found = check();
  EXPECT_TRUE(found.faults.empty());
  ASSERT_EQ(found.notes.size(), 1U);
  expectNames(found.notes[0], {"/organs/0/anchors/2", "liver"});
}

TEST_F(SceneCheckTest, AnOrganThatNothingHoldsIsNoted) {
  scene_["organs"][0]["anchors"] = json::array();
  scene_["organs"][1]["anchors"] = json::array();
  const SceneCheck found = check();
  EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(),
                          [](const std::string& note) { return note.starts_with("liver: "); }));
}

TEST_F(SceneCheckTest, ASurfaceIsPlacedByItsScene) {
  const LoadedScene as = loadScene(write());
  json& mesh = scene_["organs"][1]["mesh"];
  mesh["scale"] = 0.5;
  mesh["rotation"] = {0, 0, 1.5707963267948966};
  mesh["translation"] = {0.01, 0.02, 0.03};
  const LoadedScene placed = loadScene(write());
  const auto& before = as.description.organs[1].surface.vertex;
  const auto& now = placed.description.organs[1].surface.vertex;
  ASSERT_EQ(before.size(), now.size());
  for (std::size_t i = 0; i < now.size(); i += 100) {
    const Vec3 expected = 0.5 * Vec3(-before[i][1], before[i][0], before[i][2]) + Vec3(0.01, 0.02, 0.03);
    EXPECT_LT((now[i] - expected).norm(), 1e-15);
  }
  // Nothing asked for, nothing touched.
  mesh.erase("scale");
  mesh["rotation"] = {0, 0, 0};
  mesh["translation"] = {0, 0, 0};
  EXPECT_EQ(loadScene(write()).description.organs[1].surface.vertex, before);
}

}  // namespace
}  // namespace calot::recorder

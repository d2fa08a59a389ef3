// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <fstream>

#include "tests/recorder/formats/support/scene_with_vessels.h"

namespace calot::recorder::test {
namespace {

nlohmann::json sceneWithProcedure() {
  nlohmann::json scene = sceneWithVessels();
  scene["organs"][0]["burnThrough"] = 1.5;
  scene["vessels"][0]["burnThrough"] = 2.0;
  scene["hands"]["right"]["clips"] = 5;
  scene["fat"][0]["triangle"] =
      nlohmann::json::parse(R"({"corners": [[0, 0, 0], [0.02, 0, 0], [0, 0.02, 0]], "depth": 0.01})");
  scene["procedure"] = nlohmann::json::parse(R"({"specimen": "liver", "fat": "pad",
    "divide": [{"vessel": "branch", "patient": 3, "specimen": 2, "patientAtStart": false}], "spare": ["trunk"]})");
  scene["retraction"] = nlohmann::json::parse(R"([{"organ": "liver", "centre": [0, 0.01, 0], "radius": 0.02,
    "displacement": [0, 0.005, 0], "start": 1, "duration": 3, "stage": 0.5, "most": 3, "stiffness": 100, "damping": 4}])");
  scene["clip"] =
      nlohmann::json::parse(R"({"width": 0.001, "legs": 0.009, "leastGap": 0.002, "leastJunctionGap": 0.003})");
  scene["cautery"] =
      nlohmann::json::parse(R"({"power": 40, "reach": 0.0002, "carve": 0.001, "spot": 3e-6, "charTime": 0.5})");
  return scene;
}

TEST(SceneProcedure, EveryValueArrives) {
  const SceneDescription scene = load(sceneWithProcedure()).description;
  EXPECT_EQ(scene.organs[0].burnThrough, 1.5);
  EXPECT_EQ(scene.vessels[0].burnThrough, 2.0);
  EXPECT_EQ(scene.hands[1].clips, 5U);
  EXPECT_EQ(scene.hands[0].clips, HandDescription().clips);
  EXPECT_EQ(scene.fat[0].triangle[1], Vec3(0.02, 0.0, 0.0));
  EXPECT_EQ(scene.fat[0].triangleDepth, 0.01);
  EXPECT_EQ(scene.procedure.specimen, "liver");
  EXPECT_EQ(scene.procedure.bed, "");
  EXPECT_EQ(scene.procedure.fat, "pad");
  ASSERT_EQ(scene.procedure.divide.size(), 1U);
  EXPECT_EQ(scene.procedure.divide[0].vessel, "branch");
  EXPECT_EQ(scene.procedure.divide[0].patient, 3U);
  EXPECT_EQ(scene.procedure.divide[0].specimen, 2U);
  EXPECT_FALSE(scene.procedure.divide[0].patientAtStart);
  EXPECT_EQ(scene.procedure.spare, std::vector<std::string>{"trunk"});
  ASSERT_EQ(scene.retraction.size(), 1U);
  EXPECT_EQ(scene.retraction[0].organ, "liver");
  EXPECT_EQ(scene.retraction[0].centre, Vec3(0.0, 0.01, 0.0));
  EXPECT_EQ(scene.retraction[0].radius, 0.02);
  EXPECT_EQ(scene.retraction[0].displacement, Vec3(0.0, 0.005, 0.0));
  EXPECT_EQ(scene.retraction[0].start, 1.0);
  EXPECT_EQ(scene.retraction[0].duration, 3.0);
  EXPECT_EQ(scene.retraction[0].stage, 0.5);
  EXPECT_EQ(scene.retraction[0].most, 3.0);
  EXPECT_EQ(scene.retraction[0].stiffness, 100.0);
  EXPECT_EQ(scene.retraction[0].damping, 4.0);
  EXPECT_EQ(scene.clip.width, 0.001);
  EXPECT_EQ(scene.clip.legs, 0.009);
  EXPECT_EQ(scene.clip.minGap, 0.002);
  EXPECT_EQ(scene.clip.minJunctionGap, 0.003);
  EXPECT_EQ(scene.cautery.power, 40.0);
  EXPECT_EQ(scene.cautery.reach, 0.0002);
  EXPECT_EQ(scene.cautery.spot, 3e-6);
  EXPECT_EQ(scene.cautery.charTime, 0.5);
}

TEST(SceneProcedure, EveryFaultIsNamedWithItsPlace) {
  const auto fault = [](const char* pointer, const char* value) {
    nlohmann::json scene = sceneWithProcedure();
    scene[nlohmann::json::json_pointer(pointer)] = nlohmann::json::parse(value);
    return caught([&] { load(scene); });
  };
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/specimen", {},
              fault("/procedure/specimen", "\"spleen\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/bed", {}, fault("/procedure/bed", "\"bed\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/fat", {}, fault("/procedure/fat", "\"liver\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/divide/0/vessel", {},
              fault("/procedure/divide/0/vessel", "\"liver\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/divide/1/vessel", {},
              fault("/procedure/divide/1", "{\"vessel\": \"branch\"}"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/divide/0/patient", {"-1", "[0, 10]"},
              fault("/procedure/divide/0/patient", "-1"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/spare/0", {"divided"},
              fault("/procedure/spare/0", "\"branch\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /procedure/spare/0", {"name"},
              fault("/procedure/spare/0", "\"twig\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /retraction/0/organ", {},
              fault("/retraction/0/organ", "\"pad\""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /retraction/0/stage", {"1.5", "[0, 1]"},
              fault("/retraction/0/stage", "1.5"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /retraction/0/most", {"0.5", "[1, 10]"},
              fault("/retraction/0/most", "0.5"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /retraction/0/radius", {"0", "(0, 1]"},
              fault("/retraction/0/radius", "0"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /hands/right/clips", {"-1", "[0, 100]"},
              fault("/hands/right/clips", "-1"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /fat/0/triangle/corners", {},
              fault("/fat/0/triangle/corners", "[[0, 0, 0], [0.01, 0, 0], [0.02, 0, 0]]"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /cautery/power", {"0", "(0, 1000]"},
              fault("/cautery/power", "0"));
}

}  // namespace
}  // namespace calot::recorder::test

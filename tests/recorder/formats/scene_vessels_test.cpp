// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <fstream>

#include "sim/tissue/structure_role.h"
#include "tests/recorder/formats/support/scene_with_vessels.h"

namespace calot::recorder::test {
namespace {

using Kind = VesselEndDescription::Kind;

TEST(SceneVessels, everyValueArrives) {
  const std::vector<VesselDescription> vessels = load(sceneWithVessels()).description.vessels;
  ASSERT_EQ(vessels.size(), 2U);
  const VesselDescription& trunk = vessels[0];
  EXPECT_EQ(trunk.name, "trunk");
  EXPECT_EQ(trunk.appearance, "duct");
  ASSERT_EQ(trunk.path.size(), 3U);
  EXPECT_EQ(trunk.path[1], Vec3(-0.04, 0.001, 0));
  EXPECT_EQ(trunk.elements, 20U);
  EXPECT_EQ(trunk.radius, 0.003);
  EXPECT_EQ(trunk.wall, 0.001);
  EXPECT_EQ(trunk.material.youngModulus, 300000.0);
  EXPECT_EQ(trunk.material.massDamping, 3.0);
  EXPECT_EQ(trunk.material.stiffnessDamping, 0.02);
  EXPECT_EQ(trunk.ultimateStrain, 0.7);
  EXPECT_EQ(trunk.friction, 0.2);
  EXPECT_EQ(trunk.start.kind, Kind::fixed);
  EXPECT_EQ(trunk.end.kind, Kind::free);
  EXPECT_EQ(vessels[1].elements, VesselDescription().elements);
  EXPECT_EQ(vessels[1].ultimateStrain, VesselDescription().ultimateStrain);
  EXPECT_EQ(vessels[1].start.kind, Kind::vessel);
  EXPECT_EQ(vessels[1].start.to, "trunk");
  EXPECT_EQ(vessels[1].end.kind, Kind::organ);
  EXPECT_EQ(vessels[1].end.to, "liver");
}

TEST(SceneVessels, aSceneNeedsNone) {
  nlohmann::json scene = sceneWithVessels();
  scene["vessels"] = nlohmann::json::array();
  scene["fat"][0]["attachments"].erase(1);
  EXPECT_TRUE(load(scene).description.vessels.empty());
}

TEST(SceneVessels, everyFaultIsNamedWithItsPlace) {
  const std::vector<Change> changes{
      {"/vessels/0/material/youngModulus", "-1", "/vessels/0/material/youngModulus", {"-1", "[10, 1000000000]"}},
      {"/vessels/0/material/poissonRatio", "0.5", "/vessels/0/material/poissonRatio", {"0.5", "[0, 0.5)"}},
      {"/vessels/0/radius", "0", "/vessels/0/radius", {"0", "[0.0002, 0.02]"}},
      {"/vessels/0/wall", "0.003", "/vessels/0/wall", {"radius"}},
      {"/vessels/0/wall", "-0.001", "/vessels/0/wall", {"-0.001", "5e-05", "0.02"}},
      {"/vessels/0/elements", "0", "/vessels/0/elements", {"0", "[2, 400]"}},
      {"/vessels/0/elements", "2.5", "/vessels/0/elements", {}},
      {"/vessels/0/ultimateStrain", "0", "/vessels/0/ultimateStrain", {"0", "(0, 10]"}},
      {"/vessels/0/friction", "-0.1", "/vessels/0/friction", {"-0.1", "[0, 2]"}},
      {"/vessels/0/path", "[[0, 0, 0]]", "/vessels/0/path", {"1", "2", "1000"}},
      {"/vessels/0/path/1", "[-0.05, 0, 0]", "/vessels/0/path/1", {"0.0001"}},
      {"/vessels/0/path/2", "[-0.05, 0.0012, 0]", "/vessels/0/path/2", {"90"}},
      {"/vessels/0/path/2", "[2, 0, 0]", "/vessels/0/path/2/0", {"2", "[-1, 1]"}},
      {"/vessels/0/path/2", "[0, 0]", "/vessels/0/path/2", {"2", "3"}},
      {"/vessels/0/name", "\"liver\"", "/vessels/0/name", {}},
      {"/vessels/1/name", "\"trunk\"", "/vessels/1/name", {}},
      {"/vessels/1/end/to", "\"spleen\"", "/vessels/1/end/to", {"name"}},
      {"/vessels/1/end/to", "\"trunk\"", "/vessels/1/end/to", {"name"}},
      {"/vessels/1/start/to", "\"twig\"", "/vessels/1/start/to", {"earlier", "name"}},
      {"/vessels/1/start/to", "\"branch\"", "/vessels/1/start/to", {"earlier", "name"}},
      {"/vessels/1/end", "{\"kind\": \"vessel\", \"to\": \"trunk\"}", "/vessels/1/end/kind", {}},
      {"/vessels/1/end", "{\"kind\": \"organ\"}", "/vessels/1/end", {"\"to\""}},
      {"/vessels/1/end", "{\"kind\": \"free\", \"to\": \"liver\"}", "/vessels/1/end/to", {"free"}},
      {"/vessels/1/end", "{\"kind\": \"glued\"}", "/vessels/1/end/kind", {"fixed, free, organ, vessel"}},
      {"/vessels/1/path/1", "[-0.02, 0, 0]", "/vessels/1/end/to", {"0.02", "0.005"}},
      {"/vessels/1/path/0", "[-0.03, 0.02, 0]", "/vessels/1/start/to", {"0.0199", "0.005"}},
      {"/vessels/0/start", "", "/vessels/0", {"\"start\""}},
      {"/vessels/0/colour",
       "1",
       "/vessels/0/colour",
       {"name, appearance, role, path, elements, radius, wall, material, ultimateStrain, burnThrough, friction, start, "
        "end"}},
      {"/vessels", "{}", "/vessels", {}},
  };
  for (const Change& change : changes) expectRefused(change);
}

TEST(SceneVessels, organsVesselsAndFatTogetherHaveALimit) {
  nlohmann::json scene = sceneWithVessels();
  const auto add = [&](int number) {
    nlohmann::json one = scene["vessels"][0];
    one["name"] = std::string("twig-").append(std::to_string(number));
    scene["vessels"].push_back(one);
  };
  for (int i = 0; i < 12; ++i) add(i);
  EXPECT_EQ(load(scene).description.vessels.size(), maxStructures - 2);
  add(12);
  expectFault(ErrorKind::damaged, "scenes/small.json: /", {"17", "16"}, [&] { load(scene); });
}

TEST(SceneVessels, flippedBitsNeverCrashAndFaultsStayOneLine) {
  const nlohmann::json scene = sceneWithVessels();
  const std::string whole = nlohmann::json{{"vessels", scene["vessels"]}, {"fat", scene["fat"]}}.dump();
  int refused = 0;
  for (std::size_t i = 0; i < whole.size() * 8; i += 3) {
    std::string text = whole;
    text[i / 8] = static_cast<char>(text[i / 8] ^ (1 << (i % 8)));
    const nlohmann::json changed = nlohmann::json::parse(text, nullptr, false);
    if (changed.is_discarded() || !changed.is_object()) continue;
    nlohmann::json broken = scene;
    broken.update(changed);
    std::optional<Error> fault;
    try {
      fault = caught([&] { load(broken); });
    } catch (const nlohmann::json::type_error&) {
      continue;  // not UTF-8: cannot be written as JSON
    }
    if (!fault) continue;
    expectFault(ErrorKind::damaged, "", {}, fault);
    ++refused;
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()) / 2);
}

}  // namespace
}  // namespace calot::recorder::test

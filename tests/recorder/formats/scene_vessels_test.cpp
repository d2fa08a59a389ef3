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
      {"/vessels/0/material/youngModulus", "-1", "/vessels/0/material/youngModulus: -1 is not in [10, 1000000000]"},
      {"/vessels/0/material/poissonRatio", "0.5", "/vessels/0/material/poissonRatio: 0.5 is not in [0, 0.5)"},
      {"/vessels/0/radius", "0", "/vessels/0/radius: 0 is not in [0.0002, 0.02]"},
      {"/vessels/0/wall", "0.003", "/vessels/0/wall: not thinner than the radius"},
      {"/vessels/0/wall", "-0.001", "/vessels/0/wall: -0.001 is not in [5e-05, 0.02]"},
      {"/vessels/0/elements", "0", "/vessels/0/elements: 0 is not in [2, 400]"},
      {"/vessels/0/elements", "2.5", "/vessels/0/elements: a whole number is expected"},
      {"/vessels/0/ultimateStrain", "0", "/vessels/0/ultimateStrain: 0 is not in (0, 10]"},
      {"/vessels/0/friction", "-0.1", "/vessels/0/friction: -0.1 is not in [0, 2]"},
      {"/vessels/0/path", "[[0, 0, 0]]", "/vessels/0/path: 1 entries; from 2 to 1000 are allowed"},
      {"/vessels/0/path/1", "[-0.05, 0, 0]", "/vessels/0/path/1: nearer than 0.0001 m to the point before"},
      {"/vessels/0/path/2", "[-0.05, 0.0012, 0]",
       "/vessels/0/path/2: the path turns by 90 degrees or more at the point before"},
      {"/vessels/0/path/2", "[2, 0, 0]", "/vessels/0/path/2/0: 2 is not in [-1, 1]"},
      {"/vessels/0/path/2", "[0, 0]", "/vessels/0/path/2: 2 entries; from 3 to 3 are allowed"},
      {"/vessels/0/name", "\"liver\"", "/vessels/0/name: an organ has this name"},
      {"/vessels/1/name", "\"trunk\"", "/vessels/1/name: another vessel has this name"},
      {"/vessels/1/end/to", "\"spleen\"", "/vessels/1/end/to: the scene has no organ of this name"},
      {"/vessels/1/end/to", "\"trunk\"", "/vessels/1/end/to: the scene has no organ of this name"},
      {"/vessels/1/start/to", "\"twig\"", "/vessels/1/start/to: no earlier vessel of the scene has this name"},
      {"/vessels/1/start/to", "\"branch\"", "/vessels/1/start/to: no earlier vessel of the scene has this name"},
      {"/vessels/1/end", "{\"kind\": \"vessel\", \"to\": \"trunk\"}",
       "/vessels/1/end/kind: only a start grows out of a vessel"},
      {"/vessels/1/end", "{\"kind\": \"organ\"}", "/vessels/1/end: the key \"to\" is missing"},
      {"/vessels/1/end", "{\"kind\": \"free\", \"to\": \"liver\"}",
       "/vessels/1/end/to: a free or a fixed end is grown to nothing"},
      {"/vessels/1/end", "{\"kind\": \"glued\"}",
       "/vessels/1/end/kind: unknown word; known are fixed, free, organ, vessel"},
      {"/vessels/1/path/1", "[-0.02, 0, 0]", "/vessels/1/end/to: it lies 0.02 m away; at most 0.005 m is allowed"},
      {"/vessels/1/path/0", "[-0.03, 0.02, 0]",
       "/vessels/1/start/to: it lies 0.0199 m away; at most 0.005 m is allowed"},
      {"/vessels/0/start", "", "/vessels/0: the key \"start\" is missing"},
      {"/vessels/0/colour", "1",
       "/vessels/0/colour: unknown key; known are name, appearance, role, path, elements, radius, wall, material, "
       "ultimateStrain, burnThrough, friction, start, end"},
      {"/vessels", "{}", "/vessels: a list is expected, not object"},
  };
  for (const Change& change : changes) EXPECT_EQ(faultOf(change), change.message) << change.pointer;
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
  EXPECT_EQ(faultOf([&] { load(scene); }),
            "scenes/small.json: /: 17 structures (organs, vessels and bodies of fat); at most 16 are allowed");
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
    std::string fault;
    try {
      fault = faultOf([&] { load(broken); });
    } catch (const nlohmann::json::type_error&) {
      continue;  // not UTF-8: cannot be written as JSON
    }
    EXPECT_EQ(fault.find('\n'), std::string::npos);
    if (fault != "(no fault)") ++refused;
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()) / 2);
}

}  // namespace
}  // namespace calot::recorder::test

// SPDX-License-Identifier: GPL-3.0-or-later
// Roles of a scene's structures: as the file states them, and as they are derived where it states none.
#include "recorder/formats/scene_assets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "sim/scene/flat.h"
#include "tests/recorder/formats/support/scene_with_vessels.h"

namespace calot::recorder::test {
namespace {

using nlohmann::json;

const std::filesystem::path sourceTree = CALOT_SOURCE_DIR;

/// The scene with vessels, with a gallbladder and the tissue between it and the liver.
json wholeScene() {
  json scene = sceneWithVessels();
  scene["organs"].push_back(scene["organs"][0]);
  scene["organs"][1]["name"] = "bag";
  scene["organs"][1]["appearance"] = "gallbladder";
  scene["connective"] =
      json::parse(R"([{"name": "bed", "first": "bag", "second": "liver", "reach": 0.004, "strands": 20}])");
  return scene;
}

const std::map<std::string, std::string> definitionOfList{
    {"organs", "organ"}, {"connective", "connective"}, {"vessels", "vessel"}, {"fat", "fat"}};

void eraseRoles(json& scene) {
  for (const auto& [list, definition] : definitionOfList) {
    if (!scene.contains(list)) continue;
    for (json& one : scene[list]) one.erase("role");
  }
}

std::optional<Error> faultOfRole(const char* pointer, const char* role) {
  json scene = wholeScene();
  scene["organs"][1]["role"] = "gallbladder";
  scene[json::json_pointer(pointer)] = role;
  return caught([&] { load(scene); });
}

TEST(SceneRoles, AreReadAsTheFileStatesThem) {
  json file = wholeScene();
  file["organs"][0]["role"] = "liver";
  file["organs"][1]["role"] = "gallbladder";
  file["connective"][0]["role"] = "cystic-plate";
  file["vessels"][0]["role"] = "artery";  // whatever it looks like
  file["vessels"][1]["role"] = "cystic-duct";
  file["fat"][0]["role"] = "triangle-fat";
  const SceneDescription scene = load(file).description;
  EXPECT_EQ(scene.organs[0].role, StructureRole::liver);
  EXPECT_EQ(scene.organs[1].role, StructureRole::gallbladder);
  EXPECT_EQ(scene.connective[0].role, StructureRole::cysticPlate);
  EXPECT_EQ(scene.vessels[0].role, StructureRole::artery);
  EXPECT_EQ(scene.vessels[1].role, StructureRole::cysticDuct);
  EXPECT_EQ(scene.fat[0].role, StructureRole::triangleFat);
}

TEST(SceneRoles, OneThatIsStatedKeepsTheOthersFromBeingDerived) {
  json file = wholeScene();
  file["vessels"][0]["role"] = "other";
  const SceneDescription scene = load(file).description;
  EXPECT_EQ(scene.organs[1].role, StructureRole::other) << "whatever it looks like";
  EXPECT_EQ(scene.vessels[1].role, StructureRole::other);
  EXPECT_EQ(scene.connective[0].role, StructureRole::other);
  EXPECT_EQ(scene.fat[0].role, StructureRole::other);
}

TEST(SceneRoles, AreDerivedWhereNoneIsStated) {
  json file = wholeScene();
  json vein = file["vessels"][0];
  vein["name"] = "vein";
  vein["appearance"] = "vein";
  file["vessels"].push_back(vein);
  vein["name"] = "artery";
  vein["appearance"] = "artery";
  file["vessels"].push_back(vein);
  json cystic = file["vessels"][1];
  cystic["name"] = "cystic";
  cystic["end"]["to"] = "bag";
  file["vessels"].push_back(cystic);
  cystic["name"] = "feeder";
  cystic["appearance"] = "artery";
  file["vessels"].push_back(cystic);
  // From the gallbladder on, and ending nowhere.
  file["vessels"].push_back(cystic);
  json& begins = file["vessels"].back();
  begins["name"] = "begins";
  begins["path"] = json::parse("[[0, 0, 0], [-0.03, 0, 0]]");
  begins["start"] = json::parse(R"({"kind": "organ", "to": "bag"})");
  begins["end"] = json::parse(R"({"kind": "free"})");
  const SceneDescription scene = load(file).description;
  EXPECT_EQ(scene.organs[0].role, StructureRole::liver);
  EXPECT_EQ(scene.organs[1].role, StructureRole::gallbladder);
  EXPECT_EQ(scene.connective[0].role, StructureRole::cysticPlate);
  EXPECT_EQ(scene.fat[0].role, StructureRole::triangleFat);
  std::map<std::string, StructureRole> roles;
  for (const VesselDescription& vessel : scene.vessels) roles[vessel.name] = vessel.role;
  const std::map<std::string, StructureRole> expected{
      {"trunk", StructureRole::bileDuct},     {"branch", StructureRole::bileDuct},
      {"vein", StructureRole::other},         {"artery", StructureRole::artery},
      {"cystic", StructureRole::cysticDuct},  {"feeder", StructureRole::cysticArtery},
      {"begins", StructureRole::cysticArtery}};
  EXPECT_EQ(roles, expected) << "\"branch\" is grown to an organ, but to the liver";
}

TEST(SceneRoles, UnknownOnesAreRefusedWithTheirPlace) {
  expectFault(ErrorKind::damaged, "scenes/small.json: /organs/0/role", {"gallbladder, liver, other"},
              faultOfRole("/organs/0/role", "stomach"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /organs/0/role", {"gallbladder, liver, other"},
              faultOfRole("/organs/0/role", "cystic-duct"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /vessels/1/role",
              {"artery, bile-duct, cystic-artery, cystic-duct, other"}, faultOfRole("/vessels/1/role", "liver"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /fat/0/role", {}, faultOfRole("/fat/0/role", ""));
  expectFault(ErrorKind::damaged, "scenes/small.json: /fat/0/role", {"other, triangle-fat"},
              faultOfRole("/fat/0/role", "fat"));
  expectFault(ErrorKind::damaged, "scenes/small.json: /connective/0/role", {"cystic-plate, other"},
              faultOfRole("/connective/0/role", "bed"));
  EXPECT_FALSE(faultOfRole("/connective/0/role", "cystic-plate"));
  json scene = wholeScene();
  scene["connective"][0]["role"] = "cystic-plate";
  expectFault(ErrorKind::damaged, "scenes/small.json: /connective/0/role", {}, [&] { load(scene); });
}

/// Recordings from before scenes had roles: what is derived is what the scenes state by now.
TEST(SceneRoles, OfTheScenesThatComeWithItAreDerivedAsTheyAreStated) {
  for (const char* name : {"touch-liver", "dissect-bed", "carve-fat", "clip-and-cut", "cholecystectomy"}) {
    const LoadedScene stated = loadScene(sourceTree / "assets" / "scenes" / (std::string(name) + ".json"));
    std::vector<Asset> assets = stated.assets;
    json file = json::parse(reinterpret_cast<const char*>(assets[0].bytes.data()),
                            reinterpret_cast<const char*>(assets[0].bytes.data()) + assets[0].bytes.size());
    for (const auto& [list, definition] : definitionOfList) {
      if (!file.contains(list)) continue;
      for (const json& one : file[list]) {
        EXPECT_NE(one.value("role", "other"), "other") << name << ": " << one.at("name");
      }
    }
    eraseRoles(file);
    assets[0].bytes = bytesOf(file.dump());
    EXPECT_TRUE(saveFlat({stated.description, {}, {}}) ==
                saveFlat({sceneFromAssets(std::move(assets)).description, {}, {}}))
        << name;
  }
}

}  // namespace
}  // namespace calot::recorder::test

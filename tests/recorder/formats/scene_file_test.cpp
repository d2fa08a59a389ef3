// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "sim/instruments/instruments.h"
#include "sim/scene/flat.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::byte> bytesOfText(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

// A tetrahedron with a corner at the origin, 50 mm long, outward.
const char* const tetrahedron = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

json validScene() {
  return json::parse(R"({
    "format": "calot-scene", "formatVersion": 1, "name": "small", "version": {"major": 3, "minor": 4}, "summary": "A test.",
    "ticksPerStep": 5, "timeLimit": 60, "gravity": [0, -9.81, 0],
    "workspace": {"lower": [-0.1, -0.1, -0.1], "upper": [0.1, 0.1, 0.1]},
    "camera": {"position": [0, 0, -0.1], "target": [0, 0, 0], "verticalFieldOfView": 1.2},
    "hands": {
      "left": {"port": [-0.1, 0.1, 0], "home": [-0.02, 0, -0.02], "instrument": "grasper"},
      "right": {"port": [0.1, 0.1, 0], "home": [0.02, 0, -0.02], "instrument": "hook", "shaftRadius": 0.002,
                "couplingStiffness": 500, "largestForce": 3}
    },
    "organs": [
      {"name": "liver", "appearance": "liver", "mesh": {"file": "organs/a.obj", "unit": "mm"}, "tetrahedra": 100,
       "material": {"youngModulus": 5000, "poissonRatio": 0.45, "density": 1060, "stiffnessDamping": 0.02},
       "anchors": [{"sphere": {"centre": [0, 0, 0.05], "radius": 0.01}}]},
      {"name": "gallbladder", "appearance": "gallbladder", "mesh": {"file": "organs/a.obj", "unit": "mm"},
       "tetrahedra": 50, "material": {"youngModulus": 9000, "poissonRatio": 0.3, "density": 1020},
       "anchors": [{"nearOrgan": {"organ": "liver", "distance": 0.003}}]}
    ],
    "solver": {"tolerance": 1e-5, "sleeping": false}
  })");
}

LoadedScene load(const std::string& text, const std::string& mesh = tetrahedron) {
  return sceneFromAssets({{"scenes/small.json", bytesOfText(text)}, {"organs/a.obj", bytesOfText(mesh)}});
}

std::optional<Error> faultOf(const json& scene) {
  return caught([&] { load(scene.dump()); });
}

TEST(SceneFile, everyValueArrives) {
  const LoadedScene loaded = load(validScene().dump());
  const SceneDescription& s = loaded.description;
  EXPECT_EQ(s.name, "small");
  EXPECT_EQ(loaded.summary, validScene()["summary"]);
  EXPECT_EQ(s.majorVersion, 3U);
  EXPECT_EQ(s.minorVersion, 4U);
  EXPECT_EQ(s.ticksPerStep, 5U);
  EXPECT_EQ(s.timeLimit, 60.0);
  EXPECT_EQ(s.gravity, Vec3(0, -9.81, 0));
  EXPECT_EQ(s.workspace[0], Vec3(-0.1, -0.1, -0.1));
  EXPECT_EQ(s.workspace[1], Vec3(0.1, 0.1, 0.1));
  EXPECT_EQ(s.hands[0].port, Vec3(-0.1, 0.1, 0));
  EXPECT_EQ(s.hands[0].instrument, InstrumentKind::grasper);
  EXPECT_EQ(s.hands[0].shaftRadius, HandDescription().shaftRadius);
  EXPECT_EQ(s.hands[1].home, Vec3(0.02, 0, -0.02));
  EXPECT_EQ(s.hands[1].instrument, InstrumentKind::hook);
  EXPECT_EQ(s.hands[1].shaftRadius, 0.002);
  EXPECT_EQ(s.hands[1].couplingStiffness, 500.0);
  EXPECT_EQ(s.hands[1].maxForce, 3.0);
  ASSERT_EQ(s.organs.size(), 2U);
  EXPECT_EQ(s.organs[0].tetrahedra, 100U);
  EXPECT_EQ(s.organs[0].material.youngModulus, 5000.0);
  EXPECT_EQ(s.organs[0].material.stiffnessDamping, 0.02);
  EXPECT_EQ(s.organs[1].material.stiffnessDamping, MaterialDescription().stiffnessDamping);
  ASSERT_EQ(s.organs[0].surface.vertex.size(), 4U);
  EXPECT_NEAR(s.organs[0].surface.vertex[1].x(), 0.05, 1e-15);  // millimetres became metres
  EXPECT_EQ(s.organs[0].anchors.at(0).radius, 0.01);
  EXPECT_EQ(s.organs[1].anchors.at(0).nearOrgan, "liver");
  EXPECT_EQ(s.organs[1].anchors.at(0).distance, 0.003);
  EXPECT_EQ(s.solver.tolerance, 1e-5);
  EXPECT_EQ(s.solver.iterations, SolverDescription().iterations);
  EXPECT_FALSE(s.solver.sleeping);
  EXPECT_EQ(s.verticalFieldOfView, 1.2);
}

TEST(SceneFile, cameraLooksAtItsTargetWithUpInThePicture) {
  json scene = validScene();
  scene["camera"]["position"] = {0.03, 0.05, -0.1};
  const CameraSample camera = load(scene.dump()).description.camera;
  const Vec3 x = camera.orientation * Vec3::UnitX(), y = camera.orientation * Vec3::UnitY(),
             z = camera.orientation * Vec3::UnitZ();
  EXPECT_NEAR((z + Vec3(0.03, 0.05, -0.1).normalized()).norm(), 0.0, 1e-14);
  EXPECT_NEAR(x.y(), 0.0, 1e-14);  // level
  EXPECT_LT(y.y(), 0.0);           // y runs down
  EXPECT_NEAR((x.cross(y) - z).norm(), 0.0, 1e-14);
}

TEST(SceneFile, bytesOfARecordingGiveTheSameScene) {
  const fs::path folder = fs::path(testing::TempDir()) / "calot_scene_file_test";
  fs::create_directories(folder / "scenes");
  fs::create_directories(folder / "organs");
  std::ofstream(folder / "scenes" / "small.json") << validScene().dump(2);
  std::ofstream(folder / "organs" / "a.obj") << tetrahedron;
  const LoadedScene fromFile = loadScene(folder / "scenes" / "small.json");
  ASSERT_EQ(fromFile.assets.size(), 2U);  // the mesh is named twice and kept once
  EXPECT_EQ(fromFile.assets[0].name, "scenes/small.json");
  EXPECT_EQ(fromFile.assets[1].name, "organs/a.obj");
  EXPECT_EQ(fromFile.assets[1].bytes, bytesOfText(tetrahedron));
  const LoadedScene fromBytes = sceneFromAssets(fromFile.assets);
  EXPECT_EQ(saveFlat({fromFile.description, {}, {}}), saveFlat({fromBytes.description, {}, {}}));

  fs::remove(folder / "organs" / "a.obj");
  expectFault(ErrorKind::damaged, "scenes/small.json: /organs/0/mesh/file", {"\"organs/a.obj\""},
              [&] { loadScene(folder / "scenes" / "small.json"); });
  std::ofstream(fs::path(testing::TempDir()) / "calot_outside.obj") << tetrahedron;
  fs::create_symlink(fs::path(testing::TempDir()) / "calot_outside.obj", folder / "organs" / "a.obj");
  expectFault(ErrorKind::damaged, "scenes/small.json: /organs/0/mesh/file", {},
              [&] { loadScene(folder / "scenes" / "small.json"); });
  expectFault(ErrorKind::damaged, "scenes/none.json", {}, [&] { loadScene(folder / "scenes" / "none.json"); });
  fs::remove_all(folder);
}

struct Refused {
  const char* pointer;
  const char* value;  // JSON; empty: the key is taken away
  const char* place;
  std::vector<std::string> values;
};

TEST(SceneFile, everyFaultIsNamedWithItsPlace) {
  const std::vector<Refused> faults{
      {"/organs/0/material/poissonRatio", "0.5", "/organs/0/material/poissonRatio", {"0.5", "[0, 0.5)"}},
      {"/organs/0/material/youngModulus", "-5000", "/organs/0/material/youngModulus", {"-5000", "[10, 1000000000]"}},
      {"/organs/0/material/density", "\"heavy\"", "/organs/0/material/density", {}},
      {"/organs/0/material/density", "", "/organs/0/material", {"\"density\""}},
      {"/organs/0/colour",
       "1",
       "/organs/0/colour",
       {"name, appearance, role, mesh, tetrahedra, material, friction, burnThrough, anchors"}},
      {"/organs/0/tetrahedra", "9", "/organs/0/tetrahedra", {"9", "[10, 1000000]"}},
      {"/organs/0/tetrahedra", "100.5", "/organs/0/tetrahedra", {}},
      {"/organs/0/tetrahedra", "-100", "/organs/0/tetrahedra", {"-100", "[10, 1000000]"}},
      {"/organs/0/tetrahedra",
       "18446744073709551615",
       "/organs/0/tetrahedra",
       {"1.8446744073709552e+19", "[10, 1000000]"}},
      {"/organs/1/anchors/0/nearOrgan/organ", "\"spleen\"", "/organs/1/anchors/0/nearOrgan/organ", {"\"spleen\""}},
      {"/organs/1/anchors/0/nearOrgan/organ", "\"gallbladder\"", "/organs/1/anchors/0/nearOrgan/organ", {}},
      {"/organs/1/anchors/0", "{}", "/organs/1/anchors/0", {"\"sphere\"", "\"nearOrgan\""}},
      {"/organs/0/anchors/0/sphere/radius", "0", "/organs/0/anchors/0/sphere/radius", {"0", "(0, 1]"}},
      {"/organs/1/name", "\"liver\"", "/organs/1/name", {}},
      {"/organs/1/name", "\"Gall bladder\"", "/organs/1/name", {}},
      {"/organs", "[]", "/organs", {"0", "1", "16"}},
      {"/organs/0/mesh/unit", "\"inch\"", "/organs/0/mesh/unit", {"cm, m, mm"}},
      {"/organs/0/mesh/file", "\"organs/b.obj\"", "/organs/0/mesh/file", {"\"organs/b.obj\""}},
      {"/hands/left", "", "/hands", {"\"left\""}},
      {"/hands", "[]", "/hands", {}},
      {"/hands/left/port", "[0, 0]", "/hands/left/port", {"2", "3"}},
      {"/hands/left/port", "[0, null, 0]", "/hands/left/port/1", {}},
      {"/hands/left/port", "[-0.02, 0, -0.02]", "/hands/left/home", {"0.01"}},
      {"/hands/left/port", "[-0.9, 0, 0]", "/hands/left/port", {"0.3"}},
      {"/hands/left/home", "[0.11, 0, 0]", "/hands/left/home", {}},
      {"/hands/right/couplingStiffness", "0", "/hands/right/couplingStiffness", {"0", "(0, 100000]"}},
      {"/workspace/upper", "[0.1, -0.1, 0.1]", "/workspace/upper", {"0.01"}},
      {"/camera/target", "[0, 0, -0.1]", "/camera/target", {}},
      {"/camera/up", "[0, 0, 1]", "/camera", {"\"up\""}},
      {"/formatVersion", "2", "/formatVersion", {"2", "[1, 1]"}},
      {"/format", "\"calot-performer\"", "/format", {"\"calot-scene\""}},
      {"/version/major", "0", "/version/major", {"0", "[1, 1000000]"}},
      {"/solver/sleeping", "1", "/solver/sleeping", {}},
  };
  for (const Refused& fault : faults) {
    json scene = validScene();
    const json::json_pointer place(fault.pointer);
    if (*fault.value == '\0') {
      scene[place.parent_pointer()].erase(place.back());
    } else {
      scene[place] = json::parse(fault.value);
    }
    expectFault(ErrorKind::damaged, std::string("scenes/small.json: ") + fault.place, fault.values, faultOf(scene));
  }
}

TEST(SceneFile, pathsThatLeaveTheAssetsAreRefused) {
  for (const char* path : {"../a.obj", "organs/../../a.obj", "/etc/passwd", "./a.obj", "organs//a.obj", "organs/",
                           "..\\a.obj", "C:a.obj"}) {
    json scene = validScene();
    scene["organs"][0]["mesh"]["file"] = path;
    expectFault(ErrorKind::damaged, "scenes/small.json: /organs/0/mesh/file", {}, faultOf(scene));
  }
}

TEST(SceneFile, whatIsNotJsonIsNamedWithLineAndColumn) {
  expectFault(ErrorKind::damaged, "scenes/small.json", {"JSON", "2", "11"}, [] { load("{\n  \"name\": }"); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {}, [] { load(""); });
  expectFault(ErrorKind::damaged, "scenes/small.json: /", {}, [] { load("[]"); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {"JSON"}, [] { load("{\"gravity\": [NaN, 0, 0]}"); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {}, [] { load("{\"timeLimit\": 1e999}"); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {"\"name\""},
              [] { load("{\"name\": \"a\", \"name\": \"b\"}"); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {"32"}, [] { load(std::string(100000, '[')); });
  expectDistinct({caught([] { load(""); })->fault(), caught([] { load("{\"timeLimit\": 1e999}"); })->fault(),
                  caught([] { load("["); })->fault()});
  const std::string whole = validScene().dump();
  for (std::size_t cut = 1; cut < whole.size(); cut += 7) {
    expectFault(ErrorKind::damaged, "scenes/small.json", {"JSON"}, [&] { load(whole.substr(0, cut)); });
  }
}

TEST(SceneFile, aMeshThatIsNoBodyIsRefused) {
  const std::string text = validScene().dump();
  expectFault(ErrorKind::damaged, "organs/a.obj", {"1", "3"},
              [&] { load(text, "v 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n"); });
  expectFault(ErrorKind::damaged, "organs/a.obj", {"1"},
              [&] { load(text, "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"); });
  json metres = validScene();
  metres["organs"][0]["mesh"]["unit"] = "m";
  expectFault(ErrorKind::damaged, "organs/a.obj", {}, faultOf(metres));
  expectFault(ErrorKind::damaged, "organs/a.obj: line 1", {"\"nan\""}, [&] { load(text, "v nan 0 0\n"); });
}

TEST(SceneFile, assetsThatDoNotFitAreRefused) {
  const std::vector<std::byte> scene = bytesOfText(validScene().dump()), mesh = bytesOfText(tetrahedron);
  expectFault(ErrorKind::damaged, "scene", {}, [] { sceneFromAssets({}); });
  expectFault(ErrorKind::damaged, "scenes/small.json", {"organs/c.obj"}, [&] {
    sceneFromAssets({{"scenes/small.json", scene}, {"organs/a.obj", mesh}, {"organs/c.obj", mesh}});
  });
  expectFault(ErrorKind::damaged, "scene", {"organs/a.obj"}, [&] {
    sceneFromAssets({{"scenes/small.json", scene}, {"organs/a.obj", mesh}, {"organs/a.obj", mesh}});
  });
}

TEST(SceneFile, flippedBitsNeverCrashAndFaultsStayOneLine) {
  const std::string whole = validScene().dump();
  int refused = 0;
  for (std::size_t i = 0; i < whole.size() * 8; i += 3) {
    std::string text = whole;
    text[i / 8] = static_cast<char>(text[i / 8] ^ (1 << (i % 8)));
    if (const auto fault = caught([&] { load(text); })) {
      expectFault(ErrorKind::damaged, "", {}, fault);
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()));
}

/// The name of every instrument is known; another one is refused.
TEST(SceneFile, mountsEveryInstrument) {
  std::set<std::string> names;
  for (const InstrumentDefinition* each : instruments()) {
    json scene = validScene();
    scene["hands"]["right"]["instrument"] = each->name;
    EXPECT_EQ(load(scene.dump()).description.hands[1].instrument, each->kind) << each->name;
    names.insert(each->name);
  }
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  json scene = validScene();
  scene["hands"]["left"]["instrument"] = "laser";
  expectFault(ErrorKind::damaged, "scenes/small.json: /hands/left/instrument", {known}, faultOf(scene));
}

TEST(FindScene, byNameUnderTheRootsInTurn) {
  const fs::path base = fs::path(testing::TempDir()) / "calot_find_scene_test";
  for (const char* root : {"one", "two"}) fs::create_directories(base / root / "scenes");
  std::ofstream(base / "two" / "scenes" / "b.json") << "{}";
  std::ofstream(base / "one" / "scenes" / "a.json") << "{}";
  std::ofstream(base / "two" / "scenes" / "a.json") << "{}";
  const std::vector<fs::path> roots{base / "one", base / "two", base / "three"};
  EXPECT_EQ(findScene("a", roots), base / "one" / "scenes" / "a.json");
  EXPECT_EQ(findScene("b", roots), base / "two" / "scenes" / "b.json");
  EXPECT_EQ(findScene((base / "two" / "scenes" / "a.json").string(), {}), base / "two" / "scenes" / "a.json");
  expectFault(ErrorKind::invalid, "", {"\"c\"", "a, b"}, [&] { findScene("c", roots); });
  EXPECT_EQ(listScenes(roots).size(), 2U);
  fs::remove_all(base);
}

}  // namespace
}  // namespace calot::recorder

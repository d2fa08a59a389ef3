// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/formats/scene_assets.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "recorder/base/errors.h"
#include "recorder/base/json_faults.h"
#include "recorder/base/json_reader.h"
#include "recorder/formats/scene_connective.h"
#include "recorder/formats/scene_fat.h"
#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_organs.h"
#include "recorder/formats/scene_procedure.h"
#include "recorder/formats/scene_roles.h"
#include "recorder/formats/scene_rules.h"
#include "recorder/formats/scene_vessels.h"
#include "sim/instruments/instruments.h"
#include "sim/math/floating_point.h"
#include "sim/scene/scene_view.h"

namespace calot::recorder {
namespace {

// Camera frame C: x right, y down, z along the view.
CameraSample readCamera(const JsonPlace& place, double& verticalFieldOfView) {
  const JsonObject object = place.object(sceneRule("camera"));
  CameraSample camera;
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitY();
  object.read("position", camera.position);
  object.read("target", target);
  object.read("up", up);
  object.read("verticalFieldOfView", verticalFieldOfView);
  const Vec3 view = target - camera.position;
  if (!(view.norm() > 0.001)) object.at("target").fail("the target is the camera's own position");
  const Vec3 forward = view / view.norm();
  const Vec3 across = forward.cross(up);
  if (!(across.norm() > 0.01 * up.norm()) || !(up.norm() > 0.01)) place.fail("\"up\" is zero or along the view");
  Mat3 axes;
  axes.col(0) = across / across.norm();
  axes.col(1) = forward.cross(axes.col(0));
  axes.col(2) = forward;
  camera.orientation = Quat(axes).normalized();
  return camera;
}

std::map<std::string, InstrumentKind> instrumentNames() {
  std::map<std::string, InstrumentKind> names;
  for (const InstrumentDefinition* instrument : instruments()) names.emplace(instrument->name, instrument->kind);
  return names;
}

HandDescription readHand(const JsonPlace& place, const std::array<Vec3, 2>& workspace) {
  const JsonObject object = place.object(sceneRule("hand"));
  HandDescription hand;
  object.read("port", hand.port);
  object.read("home", hand.home);
  hand.instrument = readWord(object, "instrument", instrumentNames());
  object.read("shaftRadius", hand.shaftRadius);
  object.read("couplingStiffness", hand.couplingStiffness);
  object.read("rollStiffness", hand.rollStiffness);
  object.read("largestForce", hand.maxForce);
  object.read("slipForce", hand.slipForce);
  object.read("tearForce", hand.tearForce);
  object.read("trocarFriction", hand.trocarFriction);
  object.read("wallStiffness", hand.wallStiffness);
  object.read("clips", hand.clips);
  if ((hand.home.array() < workspace[0].array()).any() || (hand.home.array() > workspace[1].array()).any()) {
    object.at("home").fail("outside the workspace");
  }
  if (!((hand.home - hand.port).norm() >= 0.01)) object.at("home").fail("nearer than 0.01 m to the port");
  const Vec3 nearest = hand.port.cwiseMax(workspace[0]).cwiseMin(workspace[1]);
  if (!((hand.port - nearest).norm() <= 0.3)) object.at("port").fail("farther than 0.3 m from the workspace");
  return hand;
}

void checkStructureCount(const JsonObject& object) {
  std::size_t structures = 0;
  for (const char* list : {"organs", "vessels", "fat"}) {
    if (object.has(list)) structures += object.at(list).list(0, std::numeric_limits<std::size_t>::max()).size();
  }
  if (structures > maxStructures) {
    object.fail(fmt::format("{} structures (organs, vessels and bodies of fat); at most {} are allowed", structures,
                            maxStructures));
  }
}

}  // namespace

namespace {

/// What later tables name lies in earlier ones: where those have faults, these are not looked at.
void readTissues(const JsonObject& object, const FetchAsset& fetch, LoadedScene& loaded) {
  SceneDescription& scene = loaded.description;
  const std::size_t before = JsonFaults::count();
  JsonFaults::part([&] {
    for (const JsonPlace& organ : object.at("organs").list(1, maxStructures))
      JsonFaults::part([&] { scene.organs.push_back(readOrgan(organ, fetch)); });
  });
  if (JsonFaults::count() > before) return;
  JsonFaults::part([&] { checkOrgans(object.at("organs"), scene.organs); });
  JsonFaults::part([&] {
    if (object.has("connective")) scene.connective = readConnective(object.at("connective"), scene.organs);
  });
  JsonFaults::part([&] {
    if (object.has("retraction")) scene.retraction = readRetractions(object.at("retraction"), scene.organs);
  });
  const std::size_t beforeVessels = JsonFaults::count();
  JsonFaults::part([&] {
    if (object.has("vessels")) scene.vessels = readVessels(object.at("vessels"), scene.organs);
  });
  if (JsonFaults::count() > beforeVessels) return;
  JsonFaults::part([&] {
    if (object.has("fat")) {
      scene.fat = readFat(object.at("fat"), scene.organs, scene.vessels, fetch, loaded.warnings);
    }
  });
  if (JsonFaults::count() > before) return;
  if (!statesRoles(object)) deriveRoles(scene);
  JsonFaults::part([&] {
    if (object.has("procedure")) scene.procedure = readProcedure(object.at("procedure"), scene);
  });
}

void readSolver(const JsonObject& solver, SolverDescription& scene) {
  solver.read("tolerance", scene.tolerance);
  solver.read("speedTolerance", scene.speedTolerance);
  solver.read("iterations", scene.iterations);
  solver.read("responseTolerance", scene.responseTolerance);
  solver.read("responseSpeedTolerance", scene.responseSpeedTolerance);
  solver.read("contactTolerance", scene.contactTolerance);
  solver.read("contactPasses", scene.contactPasses);
  solver.read("gapTolerance", scene.gapTolerance);
  solver.read("contactIterations", scene.contactIterations);
  solver.read("sleeping", scene.sleeping);
}

}  // namespace

LoadedScene parseScene(const Asset& file, const FetchAsset& fetch) {
  const FloatingPointScope environment;  // numbers are read and the camera is turned the same in every process
  const nlohmann::json json = parseStrictJson(file.bytes, file.name);
  const JsonPlace root(json, file.name);
  const JsonObject object = root.object(sceneRule(""));
  if (object.at("format").text(maxSceneName) != "calot-scene") object.at("format").fail("\"calot-scene\" is wanted");
  std::uint32_t formatVersion = 0;
  object.read("formatVersion", formatVersion);

  LoadedScene loaded;
  SceneDescription& scene = loaded.description;
  const auto part = [](auto&& work) { JsonFaults::part(work); };
  part([&] { scene.name = readName(object, "name"); });
  part([&] {
    const JsonObject version = object.at("version").object(sceneRule("version"));
    version.read("major", scene.majorVersion);
    version.read("minor", scene.minorVersion);
  });
  object.read("summary", loaded.summary, 500);
  object.read("ticksPerStep", scene.ticksPerStep);
  object.read("timeLimit", scene.timeLimit);
  object.read("gravity", scene.gravity);

  part([&] {
    const JsonObject workspace = object.at("workspace").object(sceneRule("workspace"));
    workspace.read("lower", scene.workspace[0]);
    workspace.read("upper", scene.workspace[1]);
    if (!((scene.workspace[1] - scene.workspace[0]).array() >= 0.01).all()) {
      workspace.at("upper").fail("every side of the workspace must be at least 0.01 m long");
    }
  });
  part([&] { scene.camera = readCamera(object.at("camera"), scene.verticalFieldOfView); });
  part([&] {
    const JsonObject hands = object.at("hands").object(sceneRule("hands"));
    for (std::size_t h = 0; h < handCount; ++h)
      part([&] { scene.hands[h] = readHand(hands.at(handNames[h]), scene.workspace); });
  });

  part([&] { checkStructureCount(object); });
  readTissues(object, fetch, loaded);
  part([&] {
    if (object.has("clip")) scene.clip = readClip(object.at("clip"));
  });
  part([&] {
    if (object.has("cautery")) scene.cautery = readCautery(object.at("cautery"));
  });
  part([&] {
    if (object.has("solver")) readSolver(object.at("solver").object(sceneRule("solver")), scene.solver);
  });
  return loaded;
}

LoadedScene sceneFromAssets(std::vector<Asset> assets) {
  if (assets.empty()) throw Error(ErrorKind::damaged, "scene: there is no scene file among the assets");
  std::vector<bool> used(assets.size(), false);
  used[0] = true;
  for (std::size_t i = 0; i < assets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (assets[i].name == assets[j].name)
        throw Error(ErrorKind::damaged, "scene: two assets are called " + assets[i].name);
    }
  }
  const FetchAsset fetch = [&](const std::string& name, const JsonPlace& place) -> const Asset& {
    for (std::size_t i = 1; i < assets.size(); ++i) {
      if (assets[i].name != name) continue;
      used[i] = true;
      return assets[i];
    }
    place.fail("there is no asset \"" + name + "\"");
  };
  LoadedScene loaded = parseScene(assets[0], fetch);
  for (std::size_t i = 0; i < assets.size(); ++i) {
    if (!used[i])
      throw Error(ErrorKind::damaged, Where{assets[0].name},
                  fmt::format("the asset {} is named nowhere in it", assets[i].name));
  }
  loaded.assets = std::move(assets);
  return loaded;
}

Vec3 downOf(const Asset& sceneFile) {
  const auto* const text = reinterpret_cast<const char*>(sceneFile.bytes.data());
  const nlohmann::json scene = nlohmann::json::parse(text, text + sceneFile.bytes.size(), nullptr, false);
  const auto found = scene.is_object() ? scene.find("gravity") : scene.end();
  if (found == scene.end() || !found->is_array() || found->size() != 3) return SceneView().down;
  Vec3 gravity;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(*found)[a].is_number()) return SceneView().down;
    gravity[static_cast<int>(a)] = (*found)[a].get<double>();
  }
  return calot::downOf(gravity);
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/formats/scene_assets.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "recorder/base/errors.h"
#include "recorder/base/json_faults.h"
#include "recorder/base/record_reader.h"
#include "recorder/formats/scene_rules.h"
#include "sim/math/floating_point.h"
#include "sim/scene/scene_view.h"

namespace calot::recorder {

LoadedScene parseScene(const Asset& file, const FetchAsset& fetch) {
  const FloatingPointScope environment;  // numbers are read and the camera is rotated the same in every process
  const nlohmann::json json = parseStrictJson(file.bytes, file.name);
  const JsonPlace root(json, file.name);
  LoadedScene loaded;
  SceneDescription& scene = loaded.description;
  readRecord(root, scene);
  const auto part = [](auto&& work) { JsonFaults::part(work); };
  part([&] { loaded.summary = root.at("summary").text(500); });
  for (std::size_t i = 0; i < scene.organs.size(); ++i)
    part([&] { scene.organs[i].surface = readOrganSurface(root.at("organs").at(i).at("mesh"), fetch); });
  for (std::size_t i = 0; i < scene.fat.size(); ++i)
    part([&] { scene.fat[i].surface = readFatSurface(root.at("fat").at(i).at("mesh"), fetch, loaded.warnings); });
  applySceneRules(root, scene);
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_gravity.h"

#include <nlohmann/json.hpp>

#include "sim/scene/scene_view.h"

namespace calot::recorder {

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

// SPDX-License-Identifier: GPL-3.0-or-later
// The constants of a scene that figures may depend on, by their names in docs/reference/materials.md, each with a way
// to change it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/description.h"

namespace calot::analytics {

struct SceneConstant {
  std::string name;
  /// Times a positive factor, wherever the scene has it. @returns false where the scene has none.
  std::function<bool(SceneDescription&, double)> multiply;
};

const std::vector<SceneConstant>& sceneConstants();

/// Or null.
const SceneConstant* findSceneConstant(std::string_view name);

/// By how much an assumed constant may be off, either way: the share of it by which uncertainty and sensitivity change
/// it. Assumed itself: measured viscosities and strengths of living tissue differ by more, stiffnesses by about as
/// much.
inline constexpr double assumedChange = 0.3;

}  // namespace calot::analytics

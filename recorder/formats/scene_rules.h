// SPDX-License-Identifier: GPL-3.0-or-later
// Allowed content of each object of a scene file: the loader's side of schemas/scene.schema.json (a test compares
// them).
#pragma once

#include <string>
#include <vector>

#include "recorder/base/json_reader.h"

namespace calot::recorder {

inline constexpr int sceneFormatVersion = 1;

/// All kinds of object of a scene file; the root is the one without a definition.
const std::vector<ObjectRule>& sceneRules();

/// The bounds of a coordinate (m).
KeyRule sceneCoordinate();

/// @pre there is a rule of that definition.
const ObjectRule& sceneRule(const std::string& definition);

}  // namespace calot::recorder

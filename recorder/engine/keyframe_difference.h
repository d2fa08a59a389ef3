// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "recorder/engine/observer.h"
#include "sim/scene/model.h"

namespace calot::recorder {

/// The first field in which two keyframes differ.
struct KeyframeDifference {
  std::string field;   ///< "organ.liver/position"; "state", "haptics" where no field can be named
  std::string detail;  ///< index and both values; or empty
};

/// The first difference of two keyframes' States, or of their haptic bytes.
std::optional<KeyframeDifference> differenceOf(const Model& model, const Keyframe& recorded, const Keyframe& here);

}  // namespace calot::recorder

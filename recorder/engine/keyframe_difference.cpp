// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/keyframe_difference.h"

#include <fmt/format.h>

#include "recorder/engine/state_fields.h"

namespace calot::recorder {

std::optional<KeyframeDifference> differenceOf(const Model& model, const Keyframe& recorded, const Keyframe& here) {
  if (recorded.state == here.state) {
    if (recorded.haptics == here.haptics) return std::nullopt;
    return KeyframeDifference{"haptics", ""};
  }
  State a;
  State b;
  if (!restoreState(model, recorded.state, a) || !restoreState(model, here.state, b))
    return KeyframeDifference{"state", "the recorded bytes are no State of this scene's model"};
  const auto difference = firstDifference(stateFields(model, a), stateFields(model, b));
  if (!difference) return KeyframeDifference{"state", ""};
  return KeyframeDifference{difference->field, fmt::format("index {}: recorded {}, here {}", difference->index,
                                                           difference->first, difference->second)};
}

}  // namespace calot::recorder

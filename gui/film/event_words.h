// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "sim/scene/step_result.h"

namespace calot::gui {

/// What an event means to someone who watches: "clip on cystic-duct". Empty for events that only a machine cares for
/// (contacts, samples, solver).
/// @param structures their names, as subjects of events count
[[nodiscard]] std::string wordsFor(const Event& event, const std::vector<std::string>& structures);

/// Is it a mistake, or harm done?
[[nodiscard]] bool isFault(EventKind kind);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "gui/trainer/attempt_monitor.h"
#include "sim/scene/description.h"

namespace calot::gui {

/// What to do next in an attempt of this scene, in one or two sentences: from what the procedure asks for and what has
/// been done of it. For practice; an assessment has no hints.
/// @param summary of the scene: what is said where it has no procedure
[[nodiscard]] std::string hintFor(const SceneDescription& scene, const std::string& summary,
                                  const AttemptFigures& figures);

/// What is still undone of what the scene asks for: "the procedure is at: clipping". Where it has no procedure, it is
/// the trainee who says, but whoever touched nothing has done nothing. Empty: all is done.
[[nodiscard]] std::string whatIsUndone(const SceneDescription& scene, const AttemptFigures& figures);

}  // namespace calot::gui

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

/// Is all done that the scene asks for? Always yes where it asks for nothing: then it is the trainee who says.
[[nodiscard]] bool isDone(const SceneDescription& scene, const AttemptFigures& figures);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gui/render/translucent.h"
#include "recorder/prepared_scene.h"
#include "sim/scene/scene_view.h"

namespace calot::python {

/// A scene after a step, of a recording or of an attempt that runs: what of it is drawn, and its State.
struct Moment {
  SceneView view;
  std::vector<gui::Puff> smoke;
  std::string file;                                ///< for messages; empty: of no recording
  std::shared_ptr<recorder::PreparedScene> scene;  ///< none: another program simulates, or the State was not asked for
  std::vector<std::byte> state;
};

}  // namespace calot::python

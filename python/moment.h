// SPDX-License-Identifier: GPL-3.0-or-later
// A scene after a step, of a recording or of an attempt that runs: what of it is drawn, and its State.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "gui/render/renderer.h"
#include "gui/render/translucent.h"
#include "recorder/engine/observer.h"
#include "recorder/engine/state_fields.h"
#include "recorder/prepared_scene.h"
#include "recorder/replay.h"
#include "sim/scene/scene_view.h"

namespace calot::python {

struct Moment {
  SceneView view;
  std::vector<gui::Puff> smoke;
  std::string file;                                ///< for messages; empty: of no recording
  std::shared_ptr<recorder::PreparedScene> scene;  ///< none: another program simulates, or the State was not asked for
  std::vector<std::byte> state;
};

/// Every field of the State. @throws Error (undecided) where this version does not know what its bytes mean
std::vector<recorder::StateField> fieldsOf(const Moment& moment);

struct DrawSettings {
  int width = 0, height = 0;
  std::string quality;  ///< "film" or "interactive"
  bool mask = true, cavity = true;
  std::optional<std::array<double, 7>> camera;  ///< p_WC and q_WC (w x y z); none: the endoscope's
  std::optional<double> fieldOfView;            ///< vertical (rad); none: the endoscope's
};

/// @throws Error as gui::Renderer::render(); invalid for another quality
gui::Image draw(const Moment& moment, const DrawSettings& settings);

/// Ends the renderer's thread; a later draw() begins another.
void endRendering();

/// Moments of a recording. May be used by several threads, one at a time.
class MomentSeeker {
 public:
  explicit MomentSeeker(const std::filesystem::path& path);

  /// The moment after a step. @throws Error (invalid) where there is no such step; as recorder::Seeker::seek()
  Moment seek(std::uint64_t step);

 private:
  std::vector<gui::Puff> smokeAfter(std::uint64_t step);

  std::mutex mutex_;
  recorder::Recording recording_;
  recorder::EngineChoice choice_;
  recorder::Seeker seeker_;
  std::shared_ptr<recorder::PreparedScene> scene_;
  gui::SmokeTrail smoke_;
  std::uint64_t smokeSteps_ = 0;
};

}  // namespace calot::python

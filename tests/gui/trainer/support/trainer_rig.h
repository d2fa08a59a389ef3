// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene, a device that plays a script, and patience.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "gui/trainer/training_session.h"
#include "recorder/sources/devices/device_script.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::gui::trainertest {

/// Plays a script on the tick clock, from its beginning at each attempt.
class ScriptInput final : public AttemptInput {
 public:
  explicit ScriptInput(recorder::DeviceScript script) : script_(std::move(script)) {}
  std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) override;

  std::string refusal;  ///< not empty: open() throws it

 private:
  recorder::DeviceScript script_;
};

/// Both hands, a sample every 5 ms for so many seconds: a slow sway, and a right jaw that opens and closes each second.
recorder::DeviceScript swayingScript(double seconds);

/// touch-liver with coarse organs.
recorder::LoadedScene smallLoadedScene();

TrainingSettings smallSettings(const recorder::test::Folder& folder);

/// Waits until it is so; at most a minute. @returns whether it is
bool waitFor(const std::function<bool()>& there);

/// Waits until an attempt has been running for so long (s).
bool waitForTime(const TrainingSession& session, double time);

/// Replays a recording with every digest and force: it must be exact and complete.
void expectExact(const std::filesystem::path& file);

}  // namespace calot::gui::trainertest

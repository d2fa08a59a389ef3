// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>

#include "recorder/loop.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/window_input.h"
#include "recorder/sources/source.h"

namespace calot::gui {

/// Who acts in the trainer: opens a source for each attempt and ties it to its run. Called by the session's thread
/// alone. What open() gave is what the other functions are given.
class AttemptInput {
 public:
  AttemptInput() = default;
  AttemptInput(const AttemptInput&) = delete;
  AttemptInput& operator=(const AttemptInput&) = delete;
  virtual ~AttemptInput() = default;

  /// A source for a new attempt. @throws calot::Error where it is not there
  virtual std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) = 0;

  /// Before the first tick of a branch: hands and endoscope of the source set out from here.
  virtual void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start);

  /// Requirements of the source on its run: feedback to motors.
  virtual void drive(recorder::SampleSource& /*source*/, recorder::RunSettings& /*run*/) {}
};

/// Both hands by mouse and keyboard. An assessment wants a calibration, which is declared.
class MouseAttemptInput final : public AttemptInput {
 public:
  /// Lets an endoscope move with the hands of a source (ScopeSource).
  using AddScope = std::function<std::unique_ptr<recorder::SampleSource>(std::unique_ptr<recorder::SampleSource>,
                                                                         const SceneDescription&)>;

  /// @param mouse what the window writes to; not null. @param addScope empty: the camera is fixed
  explicit MouseAttemptInput(std::shared_ptr<recorder::MouseInput> mouse, recorder::DeviceSourceSettings settings = {},
                             AddScope addScope = {});

  std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) override;
  void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start) override;

 private:
  std::shared_ptr<recorder::MouseInput> mouse_;
  recorder::DeviceSourceSettings settings_;
  AddScope addScope_;
};

}  // namespace calot::gui

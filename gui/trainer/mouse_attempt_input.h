// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>

#include "gui/trainer/attempt_input.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/window_input.h"

namespace calot::gui {

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
  void drive(recorder::SampleSource&, recorder::RunSettings&) override {}
  void record(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick) override;

 private:
  std::shared_ptr<recorder::MouseInput> mouse_;
  recorder::DeviceSourceSettings settings_;
  AddScope addScope_;
};

}  // namespace calot::gui

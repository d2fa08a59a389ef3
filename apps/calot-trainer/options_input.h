// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "apps/calot/source_options.h"
#include "gui/trainer/attempt_input.h"

namespace calot::apps {

/// A device of the command line, or a performer to be watched, as the trainer's source. Each attempt opens it anew.
class OptionsInput final : public gui::AttemptInput {
 public:
  /// @param seed of a performer
  OptionsInput(SourceOptions options, std::uint64_t seed);

  /// Opens it once, so that what is wrong is reported before there is a window. @throws Error as makeSource
  void check(const SceneDescription& scene);

  std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) override;
  void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start) override;
  void drive(recorder::SampleSource& source, recorder::RunSettings& run) override;
  void record(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick) override;

 private:
  SourceOptions options_;
  std::uint64_t seed_;
};

}  // namespace calot::apps

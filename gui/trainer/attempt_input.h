// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "recorder/loop.h"
#include "recorder/recording/writer.h"
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

  /// Before the first tick of a branch: its hands set out from here.
  virtual void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start) = 0;

  /// What the source wants of its run: feedback to motors.
  virtual void drive(recorder::SampleSource& source, recorder::RunSettings& run) = 0;

  /// What of the source goes into the recording beside its ticks: raw samples. @param firstTick of the attempt, at
  /// which the source's tick 0 lies
  virtual void record(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick) = 0;
};

}  // namespace calot::gui

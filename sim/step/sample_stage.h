// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 1 of a step: the newest measurement of each hand, and the newest camera.
#pragma once

#include <span>

#include "sim/scene/model.h"
#include "sim/scene/samples.h"
#include "sim/scene/state.h"
#include "sim/step/step_log.h"

namespace calot {

/// Reads: the step's samples. Writes: each hand's real pose, jaw, buttons and mounted instrument, what is asked of the
/// assistant, the camera, and the digests of the samples as they came. A sample that is no measurement (isMeasurement)
/// changes nothing but is reported when it begins and when it ends.
class SampleStage {
 public:
  explicit SampleStage(const Model& model) : model_(model) {}
  /// @pre samples.size() == ticksPerStep
  void run(std::span<const TickSamples> samples, State& state, StepLog& log) const;

 private:
  void readHand(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void readRequests(std::span<const TickSamples> samples, std::size_t hand, State& state, StepLog& log) const;
  void askAssistant(std::size_t hand, bool more, State& state, StepLog& log) const;
  const Model& model_;
};

}  // namespace calot

// SPDX-License-Identifier: GPL-3.0-or-later
// What a recording's hands did, run through a scene that differs from the one in which they did it: the motion stays,
// what the tissue does is computed anew (open loop). With the recording's own scene it is a replay without comparison.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recorder/engine/observer.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"

namespace calot::recorder {

class Recording;

/// An attempt's inputs, tick by tick.
struct AttemptInputs {
  std::vector<TickSamples> samples;
  std::vector<float> lateness;  ///< of each tick (s): a figure of time says by how much the clock was stretched
  Outcome outcome = Outcome::running;
  std::uint64_t seed = 0;
};

/// All of a recording's. @throws Error as Recording::step() does.
AttemptInputs inputsOf(Recording& recording);

/// Runs whole steps of the model's length; ticks that fill none at the end are dropped. Each tick has the newest
/// contact set: a live run, whose simulation may lag behind its haptic thread, can have other forces on the hand. Then
/// ends the observers with the recorded outcome.
void runOpenLoop(const Model& model, const AttemptInputs& inputs, std::span<Observer* const> observers,
                 Executor& executor);

}  // namespace calot::recorder

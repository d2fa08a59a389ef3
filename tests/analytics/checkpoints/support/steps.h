// SPDX-License-Identifier: GPL-3.0-or-later
// Feeds an observer with steps made by hand.
#pragma once

#include <functional>
#include <vector>

#include "recorder/identity.h"
#include "recorder/observer.h"

namespace calot::analytics::support {

/// What one tick and one step hold; both hands carry a grasper unless changed.
struct StepContent {
  std::vector<TickSamples> samples;
  std::vector<recorder::TickOutcome> ticks;
  StepResult result;
};

inline recorder::AttemptHeader header() {
  recorder::AttemptHeader h;
  h.organs = {"liver", "gallbladder"};
  return h;
}

/// Runs `steps` steps through the observer; `fill(step, tick, sample, outcome)` sets each tick, `finish(step, result)`
/// each step.
inline void feed(recorder::Observer& observer, std::uint64_t steps,
                 const std::function<void(std::uint64_t, TickSamples&, recorder::TickOutcome&)>& fill,
                 const std::function<void(std::uint64_t, StepResult&)>& finish = {}) {
  const std::size_t ticksPerStep = 10;
  const StateDigest digest;
  for (std::uint64_t step = 0; step < steps; ++step) {
    StepContent content;
    content.samples.resize(ticksPerStep);
    content.ticks.resize(ticksPerStep);
    for (std::size_t t = 0; t < ticksPerStep; ++t) fill(step * ticksPerStep + t, content.samples[t], content.ticks[t]);
    content.result.step = step;
    content.result.organ.resize(2);
    if (finish) finish(step, content.result);
    observer.onStep({step, content.samples, content.ticks, content.result, digest, 0.0F, {}, {}});
  }
}

}  // namespace calot::analytics::support

// SPDX-License-Identifier: GPL-3.0-or-later
// Feeds an observer with steps made by hand.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "sim/scene/version.h"

namespace calot::analytics::support {

/// What one tick and one step hold; both hands carry a grasper unless changed.
struct StepContent {
  std::vector<TickSamples> samples;
  std::vector<recorder::TickOutcome> ticks;
  StepResult result;
};

inline recorder::AttemptHeader header() {
  recorder::AttemptHeader h;
  h.stepResultVersion = stepResultVersion;
  h.organs = {"liver", "gallbladder"};
  return h;
}

/// The scene of that header: organs with a skin of 50 cm^2 each, nothing between or beside them.
inline SceneDescription scene() {
  SceneDescription s;
  for (const char* name : {"liver", "gallbladder"}) {
    OrganDescription& organ = s.organs.emplace_back();
    organ.name = organ.appearance = name;
    organ.role = s.organs.size() == 1 ? StructureRole::liver : StructureRole::gallbladder;
    organ.surface.vertex = {Vec3(0.0, 0.0, 0.0), Vec3(0.1, 0.0, 0.0), Vec3(0.0, 0.1, 0.0)};
    organ.surface.triangle = {Index3(0, 1, 2)};
  }
  return s;
}

/// The value of a name and subject; a failure where there is none.
inline CheckpointValue valueOf(const CheckpointCollector& collector, const std::string& name,
                               const std::string& subject = "") {
  for (CheckpointValue& v : collector.values()) {
    if (v.name == name && v.subject == subject) return v;
  }
  ADD_FAILURE() << "no value " << name << " " << subject;
  return {};
}

using FillTick = std::function<void(std::uint64_t, TickSamples&, recorder::TickOutcome&)>;

/// Hands `steps` steps to `take`; `fill(tick, sample, outcome)` sets each tick, `finish(step, result)` each step.
inline void feedTo(const std::function<void(const recorder::StepRecord&)>& take, std::uint64_t steps,
                   const FillTick& fill, const std::function<void(std::uint64_t, StepResult&)>& finish = {}) {
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
    take({step, content.samples, content.ticks, content.result, digest, 0.0F, {}, {}});
  }
}

inline void feed(recorder::Observer& observer, std::uint64_t steps, const FillTick& fill,
                 const std::function<void(std::uint64_t, StepResult&)>& finish = {}) {
  feedTo([&](const recorder::StepRecord& record) { observer.onStep(record); }, steps, fill, finish);
}

/// The same with phases as a test wants them.
inline void feedPhases(CheckpointCollector& collector, std::uint64_t steps, const FillTick& fill,
                       const std::function<Phase(std::uint64_t)>& phaseOf) {
  feedTo(
      [&](const recorder::StepRecord& record) {
        Judgement judgement;
        judgement.phase = phaseOf(record.step);
        collector.take(record, judgement);
      },
      steps, fill);
}

/// A scene whose procedure is to free the gallbladder.
inline SceneDescription sceneWithProcedure() {
  SceneDescription s = scene();
  s.procedure.specimen = "gallbladder";
  return s;
}

}  // namespace calot::analytics::support

// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/accuracy/convergence/support/graded.h"

#include <gtest/gtest.h>

#include <span>

#include "analytics/checkpoints/collector.h"
#include "recorder/attempt.h"
#include "recorder/formats/scene_file.h"
#include "recorder/session.h"
#include "tests/bench/performed.h"

namespace calot::analytics {

SceneDescription sceneOf(const std::string& scene) {
  return recorder::loadScene(CALOT_SOURCE_DIR "/assets/scenes/" + scene + ".json").description;
}

std::vector<TickSamples> performedTicks(const std::string& scene, double seconds) {
  std::vector<TickSamples> ticks;
  for (const std::vector<TickSamples>& step : bench::performed(scene, seconds).step) {
    ticks.insert(ticks.end(), step.begin(), step.end());
  }
  return ticks;
}

Graded graded(const std::string& name, const SceneDescription& scene, const std::vector<TickSamples>& ticks) {
  Graded out;
  const Model::Built built = Model::build(scene);
  if (!built.model) {
    ADD_FAILURE() << name << ": " << built.error;
    return out;
  }
  const Model& model = *built.model;
  for (const OrganModel& organ : model.organs()) out.tetrahedra += organ.solid.tetrahedra().size();
  SerialExecutor executor;
  recorder::Session session(model, 1, executor);
  recorder::Provenance by;
  by.profile = "skilled";
  CheckpointCollector collector(recorder::makeHeader(model, {}, by, {}), model.scene());
  session.join(collector);
  const std::size_t every = scene.ticksPerStep;
  std::vector<recorder::TickOutcome> outcome(every);
  for (std::size_t begin = 0; begin + every <= ticks.size(); begin += every) {
    const std::span<const TickSamples> step(ticks.data() + begin, every);
    for (std::size_t i = 0; i < every; ++i) outcome[i] = session.tick(step[i]);
    session.step(step, outcome, 0.0F);
  }
  session.end(recorder::Outcome::completed);
  for (const CheckpointValue& value : collector.values()) {
    out.values[value.name + (value.subject.empty() ? "" : " " + value.subject)] = value;
  }
  return out;
}

}  // namespace calot::analytics

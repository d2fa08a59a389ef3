// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/accuracy/convergence/support/graded.h"

#include <gtest/gtest.h>

#include "analytics/uncertainty/uncertainty.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
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
  recorder::Provenance by;
  by.profile = "skilled";
  const recorder::AttemptInputs inputs{ticks, {}, recorder::Outcome::completed, 1};
  OpenLoopRun run = runIn(scene, recorder::makeHeader(*built.model, {}, by, {}), inputs, name);
  out.tetrahedra = run.tetrahedra;
  for (const CheckpointValue& value : run.values) {
    out.values[value.name + (value.subject.empty() ? "" : " " + value.subject)] = value;
  }
  return out;
}

}  // namespace calot::analytics

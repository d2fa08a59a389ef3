// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/from_observables.h"

#include <fmt/format.h>

#include "analytics/checkpoints/collector.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recorded_results.h"

namespace calot::analytics {

std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff,
                                                   recorder::Observer* also) {
  const recorder::AttemptHeader& header = recording.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  CheckpointCollector collector(header, scene, Origin::observables, cutoff);
  recorder::RecordedResults results(header, scene);
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    // Columns are counted by the header, structures by the scene: a checkpoint goes by the scene's.
    if (step.result.organ.size() != scene.organs.size() ||
        (header.stepResultVersion >= 2 && step.result.connective.size() != scene.connective.size())) {
      throw Error(ErrorKind::damaged, Where{recording.path().string(), "/observables"},
                  "has other organs or connective tissues than the scene in /scene");
    }
    const recorder::StepRecord record{step.step,   step.samples,  step.ticks, results.of(step),
                                      step.digest, step.lateness, {},         {}};
    collector.onStep(record);
    if (also != nullptr) also->onStep(record);
  }
  collector.onEnd(recording.outcome());
  if (also != nullptr) also->onEnd(recording.outcome());
  return collector.values();
}

}  // namespace calot::analytics

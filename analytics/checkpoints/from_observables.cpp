// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/from_observables.h"

#include "analytics/checkpoints/collector.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recorded_results.h"

namespace calot::analytics {

std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff,
                                                   recorder::Observer* also) {
  const recorder::AttemptHeader& header = recording.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  CheckpointCollector collector(header, scene, Origin::observables, cutoff);
  recorder::RecordedResults results(header, scene);
  std::vector<recorder::Observer*> observers{&collector};
  if (also != nullptr) observers.push_back(also);
  recorder::feedRecorded(recording, observers, &results);
  return collector.values();
}

}  // namespace calot::analytics

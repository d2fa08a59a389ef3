// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recorded_results.h"

#include <algorithm>

#include "recorder/base/errors.h"
#include "recorder/formats/scene_assets.h"

namespace calot::recorder {

RecordedResults::RecordedResults(const AttemptHeader& header, const SceneDescription& scene)
    : organs_(scene.organs.size()),
      connective_(scene.connective.size()),
      hasConnective_(header.stepResultVersion >= 2),
      judged_(header.stepResultVersion == 3 && !scene.procedure.specimen.empty()) {
  for (const DivideDescription& divide : scene.procedure.divide) {
    const auto vessel = std::find_if(scene.vessels.begin(), scene.vessels.end(),
                                     [&](const VesselDescription& v) { return v.name == divide.vessel; });
    if (vessel != scene.vessels.end()) divided_.push_back(static_cast<std::size_t>(vessel - scene.vessels.begin()));
  }
}

RecordedJudge::RecordedJudge(const AttemptHeader& header, const JudgementRules& rules)
    : RecordedJudge(header, sceneFromAssets(header.assets).description, rules) {}

const StepResult& RecordedResults::of(const RecordedStep& step) {
  if (!judged_) return step.result;
  translated_ = step.result;
  if (toClear_.empty()) {
    for (const FatResult& fat : translated_.fat) toClear_.push_back(fat.toClear);
    clearedFromStart_ = step.procedure.triangleCleared == 2;
  }
  for (std::size_t f = 0; f < translated_.fat.size(); ++f) {
    const bool any = !clearedFromStart_ && toClear_[f] > 0.0;
    translated_.fat[f].uncleared = any ? translated_.fat[f].toClear / toClear_[f] : 0.0;
  }
  for (ConnectiveResult& tissue : translated_.connective) tissue.lowerAttached = step.procedure.lowerThirdAttached;
  std::size_t bare = step.procedure.twoStructures == 2 ? divided_.size() : step.procedure.twoStructures;
  for (const std::size_t vessel : divided_) {
    if (vessel >= translated_.vessel.size()) continue;
    VesselResult& result = translated_.vessel[vessel];
    const bool counts = bare > 0 && result.partings == 0;
    result.covered = counts ? 0.0 : 1.0;
    if (counts) --bare;
  }
  return translated_;
}

void feedRecorded(Recording& recording, const std::vector<Observer*>& observers, RecordedResults* results,
                  const std::vector<TickForces>* forces) {
  std::vector<TickOutcome> ticks;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    if (results != nullptr && !results->fits(step.result))
      throw Error(ErrorKind::damaged, Where{recording.path().string(), "/observables"},
                  "has other organs or connective tissues than the scene in /scene");
    ticks = step.ticks;
    for (std::size_t i = 0; forces != nullptr && i < ticks.size(); ++i) {
      const TickForces& tick = (*forces)[static_cast<std::size_t>(n) * ticks.size() + i];
      for (std::size_t h = 0; h < handCount; ++h) {
        ticks[i].hand[h].force = tick.force[h];
        ticks[i].hand[h].torque = tick.torque[h];
      }
    }
    const StepResult& result = results != nullptr ? results->of(step) : step.result;
    const StepRecord record{n, step.samples, ticks, result, step.digest, step.lateness, {}, {}};
    for (Observer* observer : observers) observer->onStep(record);
  }
  for (Observer* observer : observers) observer->onEnd(recording.outcome());
}

}  // namespace calot::recorder

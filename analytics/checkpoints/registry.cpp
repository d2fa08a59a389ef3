// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/registry.h"

#include "analytics/checkpoints/entries.h"

namespace calot::analytics {

const std::vector<CheckpointEntry>& checkpointRegistry() {
  static const std::vector<CheckpointEntry> registry{
      // The paper's Table 2, in its order.
      elapsedTimeEntry(),
      pathLengthEntry(),
      fatRemainingEntry(),
      fatRemainingInsideEntry(),
      fatRemainingOutsideEntry(),
      cysticContactTimeEntry(),
      connectiveRemainingEntry(),
      organBurnedEntry(),
      // Motion.
      attemptDurationEntry(),
      depthPathEntry(),
      angularPathEntry(),
      speedMeanEntry(),
      speedPercentileEntry(),
      movementsEntry(),
      movementStraightnessEntry(),
      idleTimeEntry(),
      idleTimeBothEntry(),
      sparcEntry(),
      logDimensionlessJerkEntry(),
      movementJerkEntry(),
      bimanualCorrelationEntry(),
      bimanualLagEntry(),
      handRatioEntry(),
      workingVolumeEntry(),
      motionRateEntry(),
      // Phases.
      phaseDurationEntry(),
      phasePathLengthEntry(),
      phaseDepthPathEntry(),
      phaseAngularPathEntry(),
      phaseSpeedMeanEntry(),
      phaseMovementsEntry(),
      phaseIdleTimeEntry(),
      phaseSparcEntry(),
      phaseLogDimensionlessJerkEntry(),
      phaseWorkingVolumeEntry(),
      phaseForceMaximumEntry(),
      phaseForcePercentileEntry(),
      phaseForceImpulseEntry(),
      phaseCysticContactTimeEntry(),
      phaseCauteryWithoutContactEntry(),
      phaseCharredAreaEntry(),
      // Contact, force.
      contactTimeUnionEntry(),
      contactTimeSumEntry(),
      sparedContactUnionEntry(),
      sparedContactSumEntry(),
      forceMaximumEntry(),
      forcePercentileEntry(),
      forceMeanEntry(),
      forceImpulseEntry(),
      forceRateEntry(),
      // Errors and safety.
      clipErrorsEntry(),
      cauteryWithoutContactEntry(),
      connectiveTornEntry(),
      organPerforationsEntry(),
      burnPerBedEntry(),
      burnPerFatEntry(),
      burnPerDissectionEntry(),
      criticalViewEntry(),
      criticalErrorsEntry(),
      // How exact the simulation was.
      stepsMissedEntry(),
  };
  return registry;
}

const CheckpointDefinition* findCheckpoint(std::string_view name) {
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    if (entry.definition.name == name) return &entry.definition;
  }
  return nullptr;
}

bool isOfPhases(const CheckpointDefinition& definition) {
  return definition.aggregation == Aggregation::phase || definition.aggregation == Aggregation::handAndPhase;
}

const std::vector<std::string>& phaseCheckpoints() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const CheckpointEntry& entry : checkpointRegistry()) {
      if (isOfPhases(entry.definition)) list.push_back(entry.definition.name);
    }
    return list;
  }();
  return names;
}

}  // namespace calot::analytics

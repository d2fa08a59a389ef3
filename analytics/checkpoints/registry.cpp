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
      phaseMovementsEntry(),
      phaseIdleTimeEntry(),
      // Contact, force.
      contactTimeUnionEntry(),
      contactTimeSumEntry(),
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
      criticalViewEntry(),
      criticalErrorsEntry(),
  };
  return registry;
}

const CheckpointDefinition* findCheckpoint(std::string_view name) {
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    if (entry.definition.name == name) return &entry.definition;
  }
  return nullptr;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// One function per checkpoint file: its definition and how to make it. Only registry.cpp calls them.
#pragma once

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

CheckpointEntry elapsedTimeEntry();
CheckpointEntry attemptDurationEntry();
CheckpointEntry pathLengthEntry();
CheckpointEntry depthPathEntry();
CheckpointEntry angularPathEntry();
CheckpointEntry speedMeanEntry();
CheckpointEntry speedPercentileEntry();
CheckpointEntry movementsEntry();
CheckpointEntry movementStraightnessEntry();
CheckpointEntry idleTimeEntry();
CheckpointEntry idleTimeBothEntry();
CheckpointEntry sparcEntry();
CheckpointEntry logDimensionlessJerkEntry();
CheckpointEntry movementJerkEntry();
CheckpointEntry bimanualCorrelationEntry();
CheckpointEntry bimanualLagEntry();
CheckpointEntry handRatioEntry();
CheckpointEntry workingVolumeEntry();
CheckpointEntry motionRateEntry();
CheckpointEntry phaseDurationEntry();
CheckpointEntry phasePathLengthEntry();
CheckpointEntry phaseMovementsEntry();
CheckpointEntry phaseIdleTimeEntry();
CheckpointEntry phaseDepthPathEntry();
CheckpointEntry phaseAngularPathEntry();
CheckpointEntry phaseSpeedMeanEntry();
CheckpointEntry phaseSparcEntry();
CheckpointEntry phaseLogDimensionlessJerkEntry();
CheckpointEntry phaseWorkingVolumeEntry();
CheckpointEntry phaseForceMaximumEntry();
CheckpointEntry phaseForcePercentileEntry();
CheckpointEntry phaseForceImpulseEntry();
CheckpointEntry phaseCysticContactTimeEntry();
CheckpointEntry phaseCauteryWithoutContactEntry();
CheckpointEntry phaseCharredAreaEntry();
CheckpointEntry fatRemainingEntry();
CheckpointEntry fatRemainingInsideEntry();
CheckpointEntry fatRemainingOutsideEntry();
CheckpointEntry cysticContactTimeEntry();
CheckpointEntry connectiveRemainingEntry();
CheckpointEntry organBurnedEntry();
CheckpointEntry contactTimeUnionEntry();
CheckpointEntry contactTimeSumEntry();
CheckpointEntry forceMaximumEntry();
CheckpointEntry forcePercentileEntry();
CheckpointEntry forceMeanEntry();
CheckpointEntry forceImpulseEntry();
CheckpointEntry forceRateEntry();
CheckpointEntry burnPerBedEntry();
CheckpointEntry burnPerFatEntry();
CheckpointEntry burnPerDissectionEntry();
CheckpointEntry sparedContactUnionEntry();
CheckpointEntry sparedContactSumEntry();
CheckpointEntry clipErrorsEntry();
CheckpointEntry cauteryWithoutContactEntry();
CheckpointEntry connectiveTornEntry();
CheckpointEntry organPerforationsEntry();
CheckpointEntry criticalViewEntry();
CheckpointEntry criticalErrorsEntry();
CheckpointEntry stepsMissedEntry();

}  // namespace calot::analytics

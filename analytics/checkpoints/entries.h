// SPDX-License-Identifier: GPL-3.0-or-later
// One function per checkpoint file: its definition and how to make it. Only registry.cpp calls them.
#pragma once

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {

CheckpointEntry elapsedTimeEntry();
CheckpointEntry attemptDurationEntry();
CheckpointEntry pathLengthEntry();
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
CheckpointEntry clipErrorsEntry();
CheckpointEntry cauteryWithoutContactEntry();
CheckpointEntry connectiveTornEntry();
CheckpointEntry organPerforationsEntry();
CheckpointEntry criticalViewEntry();
CheckpointEntry criticalErrorsEntry();

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/reader.h"

namespace calot::analytics {

/// Every figure of a recording from what its steps recorded of themselves, without simulating: for recordings of other
/// simulation versions, whose results any later software can read. Origins are `observables` and `samples`.
/// @param cutoff of the motion filter (Hz); values that are stored are of the default.
/// @param also sees the same steps, and the end; or null.
/// @pre the recording's content chain was found intact.
/// @throws Error (damaged) where the file cannot be read, or its results do not fit its scene.
std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff = 6.0,
                                                   recorder::Observer* also = nullptr);

}  // namespace calot::analytics

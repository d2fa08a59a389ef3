// SPDX-License-Identifier: GPL-3.0-or-later
// The motion of both hands by what a recording holds of it: no simulation.
#pragma once

#include <array>

#include "analytics/checkpoints/motion_track.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::analytics {

/// A track for either hand of an attempt that was recorded so.
MotionTrack trackFor(const recorder::AttemptHeader& header);

/// Left and right, as every motion checkpoint of this attempt sees them. @param cutoff of the filter (Hz), one of
/// motionCutoffs. @throws Error (damaged) where a step cannot be read
std::array<Motion, handCount> motionOf(recorder::Recording& recording, double cutoff = motionCutoff);

}  // namespace calot::analytics

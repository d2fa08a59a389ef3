// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "recorder/live/paced_clock.h"
#include "recorder/sources/source.h"

namespace calot::recorder {

/// Number and length of the pauses of a run by its source.
struct SourcePauses {
  std::uint64_t count = 0;
  double seconds = 0.0;
};

/// Queries the source before a step; waits while it pauses, unless `stopped`, and postpones the clock accordingly.
/// @returns its status then.
SourceStatus waitWhilePaused(SampleSource& source, const std::function<bool()>& stopped, PacedClock& clock,
                             SourcePauses& pauses);

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "recorder/live/paced_clock.h"
#include "recorder/sources/source.h"

namespace calot::recorder {

/// How often and how long a source held its run.
struct SourcePauses {
  std::uint64_t count = 0;
  double seconds = 0.0;
};

/// Asks the source before a step; waits while it pauses, unless `stopped`, and moves the clock by as long.
/// @returns its status then.
SourceStatus waitWhilePaused(SampleSource& source, const std::function<bool()>& stopped, PacedClock& clock,
                             SourcePauses& pauses);

}  // namespace calot::recorder

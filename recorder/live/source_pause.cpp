// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/source_pause.h"

namespace calot::recorder {

SourceStatus waitWhilePaused(SampleSource& source, const std::function<bool()>& stopped, PacedClock& clock,
                             SourcePauses& pauses) {
  constexpr Nanoseconds askAgain = std::chrono::milliseconds(2);
  SourceStatus status = source.status();
  if (status != SourceStatus::paused) return status;
  ++pauses.count;
  const Nanoseconds began = monotonicNow();
  while (status == SourceStatus::paused && !stopped()) {
    sleepUntil(monotonicNow() + askAgain);
    status = source.status();
  }
  const Nanoseconds length = monotonicNow() - began;
  clock.pause(length);
  pauses.seconds += std::chrono::duration<double>(length).count();
  return status;
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/controlled_source.h"

namespace calot::recorder {

bool ControlledSource::next(std::uint64_t tick, TickSamples& out) {
  if (finished_ != Outcome::running) return false;
  if (!source_.next(tick, out)) return false;
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::int16_t mounted = mounted_[h];
    InstrumentKind& instrument = out.hand[h].instrument;
    if (mounted != asGiven && instrument != InstrumentKind::none) instrument = static_cast<InstrumentKind>(mounted);
  }
  return true;
}

SourceStatus ControlledSource::status() {
  // Ending takes precedence over pausing, even if the device is gone.
  if (finished_ != Outcome::running) return SourceStatus::ok;
  if (!held_) return source_.status();
  source_.rest();
  return source_.status() == SourceStatus::failed ? SourceStatus::failed : SourceStatus::paused;
}

Outcome ControlledSource::ending() const {
  const Outcome finished = finished_;
  return finished == Outcome::running ? source_.ending() : finished;
}

}  // namespace calot::recorder

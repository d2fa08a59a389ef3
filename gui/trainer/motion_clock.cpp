// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/motion_clock.h"

namespace calot::gui {

void MotionClock::asked(std::uint64_t step, Time now) {
  Entry& entry = entries_[step % kept];
  // Who reads meanwhile finds no step here.
  entry.step.store(~std::uint64_t{0}, std::memory_order_seq_cst);
  entry.ticks.store(now.time_since_epoch().count(), std::memory_order_seq_cst);
  entry.step.store(step, std::memory_order_seq_cst);
}

std::optional<MotionClock::Time> MotionClock::of(std::uint64_t step) const {
  const Entry& entry = entries_[step % kept];
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  const Time time{Time::duration(entry.ticks.load(std::memory_order_seq_cst))};
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  return time;
}

bool ClockedSource::next(std::uint64_t tick, TickSamples& out) {
  if (!source_.next(tick, out)) return false;
  if ((tick + 1) % ticksPerStep_ == 0) clock_.asked(firstStep_ + tick / ticksPerStep_, MotionClock::Time::clock::now());
  return true;
}

}  // namespace calot::gui

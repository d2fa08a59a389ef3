// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/paced_clock.h"

#include <time.h>
#include <algorithm>
#include <cerrno>

#include "recorder/engine/observer.h"

namespace calot::recorder {

namespace {

constexpr Nanoseconds lagAllowed = std::chrono::milliseconds(100);  // maxLag

Nanoseconds read(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return std::chrono::seconds(t.tv_sec) + Nanoseconds(t.tv_nsec);
}

double seconds(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }
float lagSeconds(Nanoseconds t) { return static_cast<float>(seconds(t)); }

}  // namespace

Nanoseconds monotonicNow() { return read(CLOCK_MONOTONIC); }

Nanoseconds threadCpuTime() { return read(CLOCK_THREAD_CPUTIME_ID); }

void sleepUntil(Nanoseconds time) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec t{};
  t.tv_sec = whole.count();
  t.tv_nsec = (time - whole).count();
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

bool PacedClock::mayBegin(std::uint64_t t, Nanoseconds now, std::int64_t backlog) {
  const Nanoseconds lag = now - due(t) + std::max<std::int64_t>(backlog, 0) * tick;
  if (lag <= lagAllowed) return true;
  const Nanoseconds excess = lag - lagAllowed;
  origin_ += excess;
  stretched_ += excess;
  stretchedHere_ += excess;
  // Waiting helps only where it is the simulation that is behind.
  return backlog * tick <= lagAllowed;
}

float PacedClock::finish(std::uint64_t t, Nanoseconds ready) {
  const bool waited = stretchedHere_ > Nanoseconds(0);
  const Nanoseconds late = waited ? lagAllowed + stretchedHere_ : std::max(ready - due(t), Nanoseconds(0));
  largest_ = std::max(largest_, late);
  stretchedHere_ = Nanoseconds(0);
  // Only a tick before which the clock was stretched may say so.
  const float lateness = waited ? lagSeconds(late) : std::min(lagSeconds(late), maxLag);
  if (lateness > tickDeadline) ++missed_;
  return lateness;
}

void TickReport::take(std::uint64_t done, const PacedClock& clock) {
  ticks = done;
  missedDeadlines = clock.missed();
  maxLateness = seconds(clock.maxLateness());
  stretched = seconds(clock.stretched());
}

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
  pauses.seconds += seconds(length);
  return status;
}

}  // namespace calot::recorder

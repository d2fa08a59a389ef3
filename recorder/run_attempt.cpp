// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <vector>

#include "recorder/attempt.h"
#include "recorder/live/guarded_source.h"
#include "recorder/live/haptic_thread.h"
#include "recorder/live/paced_clock.h"
#include "recorder/live/source_pause.h"

namespace calot::recorder {

namespace {

double seconds(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }

/// What ends an attempt before a step, apart from its source.
class Gate {
 public:
  Gate(const Session& session, const RunSettings& settings)
      : stepSeconds_(session.model().stepSeconds()),
        timeLimit_(session.model().scene().timeLimit),
        settings_(settings) {}

  /// @returns running where step n may begin
  [[nodiscard]] Outcome ask(std::uint64_t step) const {
    const double time = static_cast<double>(step) * stepSeconds_;
    if (timeLimit_ > 0.0 && time >= timeLimit_) return Outcome::timeLimit;
    if ((settings_.seconds > 0.0 && time >= settings_.seconds) || stopped()) return Outcome::stopped;
    return Outcome::running;
  }
  [[nodiscard]] bool stopped() const { return settings_.stop != nullptr && settings_.stop->load(); }

 private:
  double stepSeconds_, timeLimit_;
  const RunSettings& settings_;
};

float lateness(Nanoseconds due) { return static_cast<float>(std::max(0.0, seconds(monotonicNow() - due))); }

/// Ticks and steps on one thread.
void runInline(Session& session, SampleSource& source, const RunSettings& settings, RunReport& report) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  const Gate gate(session, settings);
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  PacedClock clock(monotonicNow());
  SourcePauses pauses;
  std::uint64_t tick = 0;
  while (true) {
    const SourceStatus status = waitWhilePaused(
        source, [&gate] { return gate.stopped(); }, clock, pauses);
    report.outcome = status == SourceStatus::failed ? Outcome::technicalFailure : gate.ask(session.steps());
    if (report.outcome != Outcome::running) break;
    bool open = true;
    for (std::uint32_t i = 0; i < ticksPerStep; ++i, ++tick) {
      if (settings.paced) {
        do {
          sleepUntil(clock.due(tick));
        } while (!clock.mayBegin(tick, monotonicNow(), 0));
      }
      open = source.next(tick, samples[i]);
      if (!open) break;
      ticks[i] = session.tick(samples[i]);
      if (settings.feedback) settings.feedback(ticks[i]);
      ticks[i].lateness = settings.paced ? clock.finish(tick, monotonicNow()) : 0.0F;
    }
    if (!open) {
      report.outcome = source.ending();
      break;
    }
    // A step is due when the next one's first tick is.
    session.step(samples, ticks, settings.paced ? lateness(clock.due(tick)) : 0.0F);
    report.ticks = tick;
    report.missedDeadlines = clock.missed();
    report.largestLateness = seconds(clock.largestLateness());
    report.stretched = seconds(clock.stretched());
    if (settings.progress) settings.progress(session.steps());
  }
  report.pauses = pauses.count;
  report.paused = pauses.seconds;
}

bool sameForce(const HandTick& a, const HandTick& b) {
  const auto same = [](const Vec3& x, const Vec3& y) {
    for (int i = 0; i < 3; ++i) {
      if (std::bit_cast<std::uint64_t>(x[i]) != std::bit_cast<std::uint64_t>(y[i])) return false;
    }
    return true;
  };
  return same(a.force, b.force) && same(a.torque, b.torque);
}

/// Ticks on the haptic thread, steps on this one.
void runLive(Session& session, SampleSource& source, const RunSettings& settings, RunReport& report) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  const Gate gate(session, settings);
  const std::uint64_t before = session.steps();
  session.prepare();
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  HapticThread haptics(
      session.model(), source, session.haptics(), session.contactSets(),
      {[&gate, before](std::uint64_t step) { return gate.ask(before + step); }, settings.feedback, settings.stop});
  session.onContactSets([&haptics](const ContactSets& sets) { haptics.stepDone(sets); });
  struct Listening {
    Session& session;
    ~Listening() { session.onContactSets({}); }
  } const listening{session};
  Nanoseconds due{0};
  while (haptics.takeStep(samples, ticks, due)) {
    const float late = lateness(due);
    for (std::uint32_t i = 0; i < ticksPerStep; ++i) {
      const TickOutcome again =
          session.tick(samples[i], std::array{ticks[i].hand[0].contactSet, ticks[i].hand[1].contactSet});
      bool same = true;
      for (std::size_t h = 0; h < handCount; ++h) same = same && sameForce(ticks[i].hand[h], again.hand[h]);
      if (!same) ++report.disagreements;
    }
    session.step(samples, ticks, late);
    if (settings.progress) settings.progress(session.steps());
  }
  const HapticReport& seen = haptics.finish();
  report.outcome = seen.outcome;
  report.ticks = seen.ticks;
  report.missedDeadlines = seen.missedDeadlines;
  report.largestLateness = seen.largestLateness;
  report.stretched = seen.stretched;
  report.pauses = seen.pauses.count;
  report.paused = seen.pauses.seconds;
  report.realTime = seen.realTime;
  report.tickMean = seen.cost.mean();
  report.tickP999 = seen.cost.quantile(0.999);
  report.tickLargest = seen.cost.largest();
  report.arenasGrown = haptics.arenasGrown();
}

}  // namespace

RunReport runAttempt(Session& session, SampleSource& source, const RunSettings& settings) {
  RunReport report;
  const Nanoseconds begin = monotonicNow();
  std::optional<GuardedSource> guarded;
  if (settings.live && source.watcher() != nullptr) guarded.emplace(source);
  SampleSource& asked = guarded ? *guarded : source;
  Observer* watcher = asked.watcher();
  if (watcher != nullptr) session.join(*watcher);
  if (settings.live) {
    runLive(session, asked, settings, report);
  } else {
    runInline(session, asked, settings, report);
  }
  report.steps = session.steps();
  if (watcher != nullptr) session.leave(*watcher);
  session.end(report.outcome);
  report.wallSeconds = seconds(monotonicNow() - begin);
  return report;
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
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

/// Counts the steps that missed a tolerance, and notices one after which nothing that is simulated means anything.
class StepWatch final : public Observer {
 public:
  explicit StepWatch(const Model& model) : model_(model) {}

  void onStep(const StepRecord& record) override {
    misses_.add(record.result.misses);
    if (!fault_.empty() || (record.result.misses & miss::runaway) == 0) return;
    for (const Event& event : record.result.events) {
      if (event.kind != EventKind::runaway) continue;
      fault_ = fmt::format(
          "step {}: the simulation of '{}' ran away ({:.3g} m/s); the attempt ends here, keep the "
          "recording to find out why",
          record.step, model_.structures()[event.subject].name, event.value);
      break;
    }
  }
  void onEnd(Outcome /*outcome*/) override {}
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const StepMisses& misses() const { return misses_; }

 private:
  const Model& model_;
  std::string fault_;
  StepMisses misses_;
};

float lateness(Nanoseconds due) { return static_cast<float>(std::max(0.0, seconds(monotonicNow() - due))); }

/// Ticks and steps on one thread.
void runInline(Session& session, SampleSource& source, const RunSettings& settings, const StepWatch& watch,
               RunReport& report) {
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
    report.maxLateness = seconds(clock.maxLateness());
    report.stretched = seconds(clock.stretched());
    if (settings.progress) settings.progress(session.steps());
    if (!watch.fault().empty()) {
      report.outcome = Outcome::technicalFailure;
      break;
    }
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
void runLive(Session& session, SampleSource& source, const RunSettings& settings, const StepWatch& watch,
             RunReport& report) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  const Gate gate(session, settings);
  const std::uint64_t before = session.steps();
  std::atomic<bool> ranAway{false};  // the haptic thread asks before each step
  session.precompute();
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  HapticThread haptics(session.model(), source, session.haptics(), session.contactSets(),
                       {[&gate, &ranAway, before](std::uint64_t step) {
                          return ranAway.load() ? Outcome::technicalFailure : gate.ask(before + step);
                        },
                        settings.feedback, settings.stop});
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
    ranAway.store(!watch.fault().empty());
  }
  const HapticReport& seen = haptics.finish();
  report.outcome = ranAway.load() ? Outcome::technicalFailure : seen.outcome;
  report.ticks = seen.ticks;
  report.missedDeadlines = seen.missedDeadlines;
  report.maxLateness = seen.maxLateness;
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
  StepWatch watch(session.model());
  session.join(watch);
  if (settings.live) {
    runLive(session, asked, settings, watch, report);
  } else {
    runInline(session, asked, settings, watch, report);
  }
  session.leave(watch);
  report.fault = watch.fault();
  report.misses = watch.misses();
  report.steps = session.steps();
  if (watcher != nullptr) session.leave(*watcher);
  session.end(report.outcome);
  report.wallSeconds = seconds(monotonicNow() - begin);
  return report;
}

}  // namespace calot::recorder

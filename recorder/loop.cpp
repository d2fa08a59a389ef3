// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/loop.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/live/haptic_thread.h"
#include "recorder/live/wrapped_sources.h"
#include "recorder/recording/reader.h"
#include "sim/math/fields.h"

namespace calot::recorder {

namespace {

double seconds(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }

bool isStopped(const RunSettings& settings) { return settings.stop != nullptr && settings.stop->load(); }

/// How an attempt ends before step n, apart from its source; running: it does not.
Outcome outcomeBefore(std::uint64_t step, const Model& model, const RunSettings& settings) {
  const double time = static_cast<double>(step) * model.stepSeconds();
  const double timeLimit = model.scene().timeLimit;
  if (timeLimit > 0.0 && time >= timeLimit) return Outcome::timeLimit;
  if ((settings.seconds > 0.0 && time >= settings.seconds) || isStopped(settings)) return Outcome::stopped;
  return Outcome::running;
}

float lateness(Nanoseconds due) { return static_cast<float>(std::max(0.0, seconds(monotonicNow() - due))); }

/// Ticks and steps on one thread.
void runInline(Session& session, SampleSource& source, const RunSettings& settings, const StepWatch& watch,
               RunReport& report) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  PacedClock clock(monotonicNow());
  SourcePauses pauses;
  std::uint64_t tick = 0;
  while (true) {
    const SourceStatus status = waitWhilePaused(
        source, [&] { return isStopped(settings); }, clock, pauses);
    report.outcome = status == SourceStatus::failed ? Outcome::technicalFailure
                                                    : outcomeBefore(session.steps(), session.model(), settings);
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
    report.take(tick, clock);
    if (settings.progress) settings.progress(session.steps());
    if (watch.ranAway()) {
      report.outcome = Outcome::technicalFailure;
      break;
    }
  }
  report.pauses = pauses.count;
  report.paused = pauses.seconds;
}

/// Bit for bit.
bool sameForces(const TickOutcome& a, const TickOutcome& b) {
  const auto same = [](const Vec3& x, const Vec3& y) { return std::ranges::equal(bytesOf(x), bytesOf(y)); };
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!same(a.hand[h].force, b.hand[h].force) || !same(a.hand[h].torque, b.hand[h].torque)) return false;
  }
  return true;
}

/// Ticks on the haptic thread, steps on this one.
void runLive(Session& session, SampleSource& source, const RunSettings& settings, const StepWatch& watch,
             RunReport& report) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  const std::uint64_t before = session.steps();
  std::atomic<bool> ranAway{false};  // the haptic thread asks before each step
  session.precompute();
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  HapticThread haptics(session.model(), source, session.haptics(), session.contactSets(),
                       {[&](std::uint64_t step) {
                          return ranAway.load() ? Outcome::technicalFailure
                                                : outcomeBefore(before + step, session.model(), settings);
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
          session.tick(samples[i], NamedSets{ticks[i].hand[0].contactSet, ticks[i].hand[1].contactSet});
      if (!sameForces(ticks[i], again)) ++report.disagreements;
    }
    session.step(samples, ticks, late);  // with the forces that the hands felt
    if (settings.progress) settings.progress(session.steps());
    ranAway.store(watch.ranAway());
  }
  const HapticReport& seen = haptics.finish();
  report.outcome = ranAway.load() ? Outcome::technicalFailure : seen.outcome;
  static_cast<TickReport&>(report) = seen;
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
  StepWatch watch;
  session.join(watch);
  if (settings.live) {
    runLive(session, asked, settings, watch, report);
  } else {
    runInline(session, asked, settings, watch, report);
  }
  session.leave(watch);
  report.fault = watch.fault(session.model());
  report.misses = watch.misses();
  report.steps = session.steps();
  if (watcher != nullptr) session.leave(*watcher);
  session.end(report.outcome);
  report.wallSeconds = seconds(monotonicNow() - begin);
  return report;
}

StepwiseAttempt::StepwiseAttempt(std::shared_ptr<PreparedScene> scene, std::vector<Asset> assets, std::uint64_t seed)
    : scene_(std::move(scene)),
      assets_(std::move(assets)),
      seed_(seed),
      session_(scene_->model(), seed, executor_, scene_->services()),
      hands_(scene_->model().scene()),
      samples_(scene_->model().scene().ticksPerStep) {
  session_.join(watch_);
}

void StepwiseAttempt::record(const std::filesystem::path& target, const AttemptSettings& settings,
                             const Provenance& provenance, WriterOptions options) {
  if (writer_) throw Error(ErrorKind::invalid, Where{target.string()}, "the attempt is recorded already");
  if (ended_ || steps() > 0)
    throw Error(ErrorKind::invalid, Where{target.string()},
                "a recording begins with an attempt's first step: reset, then record");
  AttemptSettings own = settings;
  own.seed = seed_;
  writer_ =
      std::make_unique<RecordingWriter>(target, makeHeader(model(), assets_, provenance, own), std::move(options));
  session_.join(*writer_);
}

Outcome StepwiseAttempt::step(const HandCommands& wanted) {
  if (ended_ || outcome_ != Outcome::running)
    throw Error(ErrorKind::invalid, "the attempt is over: reset begins another one");
  hands_.next(wanted, samples_);
  session_.run({samples_, {}, 0.0F});
  outcome_ = watch_.ranAway() ? Outcome::technicalFailure : outcomeBefore(steps(), model(), {});
  return outcome_;
}

void StepwiseAttempt::end(Outcome outcome) {
  if (ended_) return;
  ended_ = true;
  if (outcome_ == Outcome::running) outcome_ = outcome;
  session_.end(outcome_);
  if (writer_) writer_->finish();
  scene_->save();
}

AttemptInputs inputsOf(Recording& recording) {
  AttemptInputs inputs;
  inputs.outcome = recording.outcome();
  inputs.seed = recording.header().seed;
  inputs.samples.reserve(recording.tickCount());
  inputs.lateness.reserve(recording.tickCount());
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    inputs.samples.insert(inputs.samples.end(), step.samples.begin(), step.samples.end());
    for (const TickOutcome& tick : step.ticks) inputs.lateness.push_back(tick.lateness);
  }
  inputs.lateness.resize(inputs.samples.size(), 0.0F);
  return inputs;
}

void runOpenLoop(const Model& model, const AttemptInputs& inputs, std::span<Observer* const> observers,
                 Executor& executor) {
  Session session(model, inputs.seed, executor);
  for (Observer* observer : observers) session.join(*observer);
  const std::size_t every = model.scene().ticksPerStep;
  std::vector<TickOutcome> late(every);
  for (std::size_t begin = 0; begin + every <= inputs.samples.size(); begin += every) {
    const std::span<const TickSamples> step(inputs.samples.data() + begin, every);
    for (std::size_t i = 0; i < every; ++i) {
      const auto newest = static_cast<std::int64_t>(session.steps()) - 1;
      for (HandTick& hand : late[i].hand) hand.contactSet = newest;
      late[i].lateness = begin + i < inputs.lateness.size() ? inputs.lateness[begin + i] : 0.0F;
    }
    session.run({step, late, 0.0F});
  }
  session.end(inputs.outcome);
}

}  // namespace calot::recorder

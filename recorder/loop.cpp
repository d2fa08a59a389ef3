// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/loop.h"

#include <fmt/format.h>
#include <sodium.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/engine/session.h"
#include "recorder/live/haptic_thread.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"
#include "recorder/sources/source.h"
#include "sim/scene/version.h"

#ifndef CALOT_VERSION
#error "CALOT_VERSION is set by the build"
#endif

namespace calot::recorder {

std::string newUuid() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  std::array<unsigned char, 16> b{};
  randombytes_buf(b.data(), b.size());
  b[6] = static_cast<unsigned char>((b[6] & 0x0FU) | 0x40U);
  b[8] = static_cast<unsigned char>((b[8] & 0x3FU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", b[i]);
  }
  return text;
}

std::string softwareName() { return "calot " CALOT_VERSION; }

std::string buildName() {
  std::string compiler;
#if defined(__clang__)
  compiler = fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  compiler = fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
  return fmt::format("{} {} {}", compiler, CALOT_BUILD_TYPE, CALOT_REVISION);
}

AttemptHeader makeHeader(const Model& model, std::vector<Asset> assets, const Provenance& provenance,
                         const AttemptSettings& settings) {
  AttemptHeader header;
  static_cast<AttemptSettings&>(header) = settings;
  header.attempt = newUuid();
  header.startUtc = presentDate();
  header.software = softwareName();
  header.build = buildName();
  header.simulationVersion = simulationVersion;
  header.stepResultVersion = stepResultVersion;
  header.provenance = provenance;
  header.ticksPerStep = model.scene().ticksPerStep;
  header.sceneName = model.scene().name;
  header.sceneMajor = model.scene().majorVersion;
  header.sceneMinor = model.scene().minorVersion;
  header.assets = std::move(assets);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    if constexpr (Kind::hasStructures) {
      for (const StructureModel& structure : model.structures()) {
        if (structure.kind == kind) Kind::namesOf(header).push_back(structure.name);
      }
    }
  });
  header.layout = model.layout();
  header.deviceSamples = !provenance.device.empty();
  return header;
}

namespace {

/// A source with a watcher in a live run: one thread requests ticks, another reports steps. Sources are not
/// thread-safe; this serialises the two.
class GuardedSource final : public WrappedSource, private Observer {
 public:
  /// @param source outlives this; it has a watcher
  explicit GuardedSource(SampleSource& source) : WrappedSource(source), watcher_(*source.watcher()) {}

  bool next(std::uint64_t tick, TickSamples& out) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return source_.next(tick, out);
  }
  void rest() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    source_.rest();
  }
  [[nodiscard]] Observer* watcher() override { return this; }

 private:
  void onStep(const StepRecord& record) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    watcher_.onStep(record);
  }
  void onEnd(Outcome outcome) override { watcher_.onEnd(outcome); }

  Observer& watcher_;
  std::mutex mutex_;
};

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
  std::uint64_t tick = 0;
  while (true) {
    const SourceStatus status = waitWhilePaused(
        source, [&] { return isStopped(settings); }, clock, report.pauses);
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
      const bool same = sameForces(ticks[i].hand[0], again.hand[0]) && sameForces(ticks[i].hand[1], again.hand[1]);
      if (!same) ++report.disagreements;
    }
    session.step(samples, ticks, late);  // with the forces that the hands felt
    if (settings.progress) settings.progress(session.steps());
    ranAway.store(watch.ranAway());
  }
  const HapticReport& seen = haptics.finish();
  static_cast<HapticReport&>(report) = seen;
  if (ranAway.load()) report.outcome = Outcome::technicalFailure;
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
  report.runaway = watch.runaway(session.model());
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

void refuseParent(const Recording& parent) {
  const AttemptHeader& header = parent.header();
  const std::string name = parent.path().string();
  if (header.simulationVersion != simulationVersion) {
    throw Error(ErrorKind::undecided, Where{name},
                fmt::format("recorded with simulation version {}, this build has {}: it cannot be branched here",
                            header.simulationVersion, simulationVersion));
  }
  if (header.mode == Mode::assessment) {
    throw Error(ErrorKind::refused, Where{name}, "made in assessment mode, which has no branches");
  }
}

std::uint64_t forkStepAt(const Recording& parent, double time) {
  const AttemptHeader& header = parent.header();
  const double stepSeconds = header.tickSeconds * static_cast<double>(header.ticksPerStep);
  // A time that was written in decimals means the step's end that is next to it, not the one before.
  const double steps = std::floor(time / stepSeconds + 1e-6);
  if (!(steps >= 1.0)) {
    throw Error(ErrorKind::invalid, Where{parent.path().string(), fmt::format("fork at {} s", time)},
                fmt::format("it lies at the end of the first step, {} s, or later", stepSeconds), {Remedy::moveFork});
  }
  if (steps > static_cast<double>(parent.stepCount())) {
    throw Error(ErrorKind::invalid, Where{parent.path().string(), fmt::format("fork at {} s", time)},
                fmt::format("the recording ends at {} s", parent.seconds()), {Remedy::moveFork});
  }
  return static_cast<std::uint64_t>(steps) - 1;
}

AttemptHeader branchHeader(const Recording& parent, const Model& model, std::uint64_t forkStep,
                           const Provenance& provenance) {
  const AttemptHeader& from = parent.header();
  AttemptSettings settings = from;
  settings.mode = Mode::practice;
  AttemptHeader header = makeHeader(model, from.assets, provenance, settings);
  header.parent = from.attempt;
  header.forkStep = static_cast<std::int64_t>(forkStep);
  return header;
}

std::optional<Divergence> takeParent(Recording& parent, Session& session, std::uint64_t forkStep,
                                     const StepProgress& progress) {
  LocalEngine engine(session);
  return follow(parent, engine, forkStep + 1, {}, progress);
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/replay.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "recorder/formats/scene_assets.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recorded_results.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/verification.h"
#include "sim/scene/version.h"

namespace calot::recorder {

void StepMisses::add(std::uint32_t misses) {
  ++steps;
  any += misses != 0 ? 1U : 0U;
  solver += (misses & miss::solver) != 0 ? 1U : 0U;
  contact += (misses & miss::contact) != 0 ? 1U : 0U;
  heldBack += (misses & miss::speed) != 0 ? 1U : 0U;
}

void StepMisses::add(const StepMisses& other) {
  steps += other.steps;
  any += other.any;
  solver += other.solver;
  contact += other.contact;
  heldBack += other.heldBack;
}

void StepWatch::onStep(const StepRecord& record) {
  misses_.add(record.result.misses);
  if (ranAway_ || (record.result.misses & miss::runaway) == 0) return;
  ranAway_ = true;
  const std::vector<Event>& events = record.result.events;
  const auto at =
      std::find_if(events.begin(), events.end(), [](const Event& e) { return e.kind == EventKind::runaway; });
  if (at != events.end()) event_ = *at;
}

std::optional<Runaway> StepWatch::runaway(const Model& model) const {
  if (!event_) return std::nullopt;
  return Runaway{event_->step, model.structures()[event_->subject].name, event_->value};
}

namespace {

std::optional<Divergence> runOnce(Recording& recording, const EngineChoice& choice, const ReplaySettings& settings,
                                  const std::vector<Observer*>& observers) {
  WorkerPool pool(choice.isInside() ? settings.threads : 1);
  const std::unique_ptr<Engine> engine = choice.make(pool);
  engine->start(recording.header().seed);
  const std::optional<Divergence> first =
      follow(recording, *engine, recording.stepCount(), observers, settings.progress);
  for (Observer* observer : observers) observer->onEnd(recording.outcome());
  return first;
}

/// @throws Error (invalid) where they are not there.
std::vector<Segment> partOf(const Recording& recording, const std::vector<Segment>& all,
                            const std::pair<std::size_t, std::size_t>& part) {
  if (part.first > part.second || part.second >= all.size()) {
    throw Error(ErrorKind::invalid, Where{recording.path().string()},
                fmt::format("it has {} segments, from 0 on: there are none from {} to {}", all.size(), part.first,
                            part.second));
  }
  const auto at = [&](std::size_t i) { return all.begin() + static_cast<std::ptrdiff_t>(i); };
  return {at(part.first), at(part.second) + 1};
}

/// The first step from this one on that has a keyframe; the last one where none has.
std::uint64_t nextKeyframe(const Recording& recording, std::uint64_t step) {
  const std::vector<std::uint64_t>& steps = recording.keyframeSteps();
  const auto next = std::lower_bound(steps.begin(), steps.end(), step);
  return next == steps.end() ? recording.stepCount() : *next;
}

}  // namespace

std::optional<Divergence> follow(Recording& recording, Engine& engine, std::uint64_t end,
                                 const std::vector<Observer*>& observers, const StepProgress& progress) {
  StepComparison comparison(recording, engine);
  std::vector<TickSamples> samples;
  std::vector<TickOutcome> logged;
  std::uint64_t announced = engine.steps();
  while (engine.steps() < end && !comparison.done()) {
    const std::uint64_t n = engine.steps();
    try {
      // Not beyond a keyframe: it is compared with the engine's own, which has to be there then.
      const std::uint64_t ahead = std::min({end, n + engine.takesAhead(), nextKeyframe(recording, n) + 1});
      for (announced = std::max(announced, n); announced < ahead; ++announced) {
        const RecordedStep& coming = recording.step(announced);
        engine.announce({coming.samples, coming.ticks, coming.lateness});
      }
      const RecordedStep& recorded = recording.step(n);
      samples = recorded.samples;  // an observer may read on in the recording
      logged = recorded.ticks;
      const float lateness = recorded.lateness;
      const EngineStep step = engine.step({samples, logged, lateness});
      StepRecord record{n, samples, step.ticks, step.result, step.digest, lateness, {}, {}};
      if (engine.takesAhead() == 0) {
        record.keyframe = [&] { return engine.keyframe(); };
        record.view = [&] { return engine.view(); };
      }
      for (Observer* observer : observers) observer->onStep(record);
      comparison.compare(step);
    } catch (const std::out_of_range& e) {
      comparison.fail({n, n * recording.header().ticksPerStep, "force", "contact set", e.what()});
      break;
    }
    if (progress) progress(n + 1, end);
  }
  return comparison.first();
}

namespace {

void judge(Recording& recording, const ChainVerdict& chain, const ReplaySettings& settings, ReplayReport& report) {
  const AttemptHeader& header = recording.header();
  report.attempt = header.attempt;
  report.complete = recording.complete();
  report.outcome = recording.outcome();
  report.steps = recording.stepCount();
  report.seconds = recording.seconds();
  report.simulationVersion = header.simulationVersion;
  for (std::size_t i = 0; i < 32; ++i) report.chainHead[i] = static_cast<std::byte>(recording.status().back().chain[i]);
  report.chain = chain;
  report.signature = recording.signature();
  if (report.steps == 0 && chain.intact()) {
    report.verdict = ReplayVerdict::undecided;
    report.error = "it has no steps: there is nothing to prove";
    return;
  }
  const bool otherVersion = header.simulationVersion != simulationVersion;
  // A damaged recording may be compared with any engine: none can prove it.
  const bool foreign = otherVersion && (settings.engine.anyway ||
                                        (!chain.intact() && commandOfEngine(header.simulationVersion).empty()));
  EngineRequest request = settings.engine;
  request.anyway = foreign;
  const EngineChoice choice(recording, request);
  // Another version may have other components; digests of different layouts say nothing field by field.
  if (!choice.fits(header.layout)) {
    report.verdict = foreign && chain.intact() ? ReplayVerdict::undecided : ReplayVerdict::diverged;
    report.finding = ReplayFinding::otherLayout;
    return;
  }
  report.error = choice.nameFault();
  if (!report.error.empty()) {
    report.verdict = ReplayVerdict::diverged;
    report.finding = ReplayFinding::otherNames;
    return;
  }
  const bool sameResults = foreign || header.stepResultVersion == stepResultVersion;
  std::vector<Observer*> observers;
  if (settings.observers && sameResults) observers = settings.observers(header, choice.scene());
  std::vector<Segment> segments = segmentsOf(recording);
  if (settings.part) segments = partOf(recording, segments, *settings.part);
  const unsigned threads = settings.threads == 0 ? std::thread::hardware_concurrency() : settings.threads;
  // Recorded results stand for those that were computed only if they have all of the engine's fields.
  const bool complete = !choice.isInside() || header.stepResultVersion == stepResultVersion;
  const bool inSegments = settings.part || (threads > 1 && segments.size() > 1 && complete);
  if (inSegments) {
    const bool tell = !settings.part && !observers.empty();
    std::vector<TickForces> forces(tell ? static_cast<std::size_t>(recording.tickCount()) : 0);
    const SegmentsVerdict verdict =
        verifySegments(recording.path(), choice, segments, threads, settings.progress, tell ? &forces : nullptr);
    report.divergence = verdict.divergence;
    report.reproducible = verdict.reproducible;
    report.misses = verdict.misses;
    if (!report.divergence && tell) feedRecorded(recording, observers, nullptr, &forces);
  } else {
    StepWatch watch;
    observers.push_back(&watch);
    report.divergence = runOnce(recording, choice, settings, observers);
    report.misses = watch.misses();
    if (report.divergence) {
      ReplaySettings again = settings;
      again.progress = nullptr;
      report.reproducible = runOnce(recording, choice, again, {}) == report.divergence;
    }
  }
  choice.save();
  report.finding = ReplayFinding::compared;
  if (settings.part)
    report.part = {{settings.part->first, settings.part->second}, {segments.front().first, segments.back().end - 1}};
  const bool differs = report.divergence || !chain.intact();
  report.verdict = foreign && chain.intact() ? ReplayVerdict::undecided
                   : differs                 ? ReplayVerdict::diverged
                   : settings.part           ? ReplayVerdict::consistent
                                             : ReplayVerdict::exact;
}

}  // namespace

std::optional<ErrorKind> ReplayReport::fault() const {
  switch (verdict) {
    case ReplayVerdict::exact:
    case ReplayVerdict::consistent:
      break;
    case ReplayVerdict::diverged:
      return ErrorKind::refused;
    case ReplayVerdict::damaged:
      return ErrorKind::damaged;
    case ReplayVerdict::undecided:
      return ErrorKind::undecided;
  }
  return std::nullopt;
}

std::string messageWithout(const std::filesystem::path& recording, const Error& error) {
  const Where& where = error.where();
  if (where.file != recording.string() && where.file != recording.filename().string()) return error.what();
  return where.place.empty() ? error.fault() : where.place + ": " + error.fault();
}

ReplayReport replayRecording(const std::filesystem::path& path, const ReplaySettings& settings) {
  const auto begin = std::chrono::steady_clock::now();
  ReplayReport report;
  report.path = path;
  try {
    const ChainVerdict chain = probe(path);
    Recording recording(path);
    judge(recording, chain, settings, report);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::damaged && e.kind() != ErrorKind::undecided) throw;
    const bool broken = report.chain && !report.chain->intact();
    report.verdict = e.kind() == ErrorKind::damaged ? ReplayVerdict::damaged
                     : broken                       ? ReplayVerdict::diverged
                                                    : ReplayVerdict::undecided;
    report.error = messageWithout(path, e);
    report.remedies = e.remedies();
  }
  report.wallSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

Seeker::Seeker(Recording& recording, const EngineChoice& choice)
    : recording_(recording), choice_(choice), engine_(choice_.make(executor_)) {}

void Seeker::seek(std::uint64_t step) {
  const auto nearest = recording_.keyframeAtOrBefore(step);
  // Going on from here is as good as a keyframe that lies behind.
  const bool goOn =
      begun_ && engine_->steps() <= step + 1 && (!nearest || recording_.keyframeSteps()[*nearest] < engine_->steps());
  if (!goOn && nearest) {
    const Keyframe keyframe = recording_.keyframe(*nearest);
    if (!engine_->restore(keyframe, std::nullopt)) {
      throw Error(ErrorKind::damaged, Where{recording_.path().string(), "/keyframes"},
                  fmt::format("the one of step {} is not a State of the scene's model", keyframe.step));
    }
  } else if (!goOn) {
    engine_->start(recording_.header().seed);
  }
  if (!goOn) differs_.reset();
  begun_ = true;
  while (engine_->steps() <= step) advance();
}

SceneView Seeker::view() {
  if (!fallen_) {
    const AttemptHeader& header = recording_.header();
    const std::vector<Event> events = recording_.events();
    const bool any =
        std::any_of(events.begin(), events.end(), [](const Event& e) { return e.kind == EventKind::clipDropped; });
    fallen_.emplace(any ? sceneFromAssets(header.assets).description.clip : ClipDescription(),
                    header.tickSeconds * header.ticksPerStep);
    for (const Event& event : events) fallen_->add(event);
  }
  SceneView view = engine_->view();
  fallen_->show(view);
  return view;
}

bool Seeker::isAsRecorded(const RecordedStep& recorded, const EngineStep& step) {
  const AttemptHeader& header = recording_.header();
  if (isMinimal(header) || header.formatVersion == 1) return recorded.digest.component == step.digest.component;
  shorten(step.digest, brief_);
  return recorded.brief.state == brief_.state;
}

void Seeker::advance() {
  try {
    const RecordedStep& recorded = recording_.step(engine_->steps());
    const EngineStep step = engine_->step({recorded.samples, recorded.ticks, recorded.lateness});
    if (!differs_ && !isAsRecorded(recorded, step)) differs_ = recorded.step;
  } catch (const std::out_of_range& e) {
    throw Error(ErrorKind::damaged, Where{recording_.path().string(), "/ticks"}, e.what());
  }
}

}  // namespace calot::recorder

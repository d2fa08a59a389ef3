// SPDX-License-Identifier: GPL-3.0-or-later
// calot record and calot branch: an attempt from its start, or from a moment of another one.

#include <cmath>

#include "analytics/checkpoints/replay_words.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/source_options.h"
#include "recorder/base/files.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/scope/scope_source.h"
#include "recorder/sources/source.h"

namespace calot::apps {
namespace {

struct FinishedRun {
  std::string attempt;  ///< uuid
  std::string file;
  double stepSeconds = 0.0;
  recorder::RunReport report;
  std::string why;     ///< the source's word on why it failed, or empty
  bool paced = false;  ///< or live: deadlines mean something
  bool live = false;
};

Json runJson(const FinishedRun& run, double seconds) {
  const recorder::RunReport& r = run.report;
  Json out{{"attempt", run.attempt},
           {"file", run.file},
           {"outcome", wordFor(r.outcome)},
           {"steps", r.steps},
           {"seconds", seconds},
           {"wall_seconds", r.wallSeconds},
           {"missed_tolerance", missesJson(r.misses)},
           {"ticks", r.ticks},
           {"missed_deadlines", r.missedDeadlines},
           {"largest_lateness_s", r.maxLateness},
           {"clock_stretched_s", r.stretched},
           {"pauses", r.pauses.count},
           {"paused_s", r.pauses.seconds}};
  if (!run.why.empty()) out["source_status"] = run.why;
  if (run.live) {
    out["real_time_thread"] = r.realTime;
    out["tick_cpu_mean_s"] = r.cost.mean();
    out["tick_cpu_p999_s"] = r.cost.quantile(0.999);
    out["tick_cpu_largest_s"] = r.cost.largest();
    out["arenas_grown"] = r.arenasGrown;
    out["force_disagreements"] = r.disagreements;
  }
  return out;
}

std::string runText(const FinishedRun& run, double seconds) {
  const recorder::RunReport& r = run.report;
  const bool failed = r.outcome == recorder::Outcome::technicalFailure && !run.why.empty();
  std::string text = fmt::format("{}: attempt {}, {:.2f} s, {}{}{}\n", run.file, run.attempt, seconds,
                                 wordFor(r.outcome), failed ? ": " : "", failed ? run.why : "");
  if (r.misses.any > 0) text += fmt::format("{}: {}\n", run.file, analytics::wordsFor(r.misses));
  if (run.paced) {
    text +=
        fmt::format("{}: {} of {} ticks missed their deadline, at most {:.1f} ms late, clock stretched by {:.3f} s\n",
                    run.live ? "live" : "paced", r.missedDeadlines, r.ticks, 1e3 * r.maxLateness, r.stretched);
  }
  if (run.live) {
    text += fmt::format(
        "haptic tick: {:.1f} us of CPU on average, {:.1f} us at 99.9 %, {:.1f} us at most; {}; {} arenas grown\n",
        1e6 * r.cost.mean(), 1e6 * r.cost.quantile(0.999), 1e6 * r.cost.largest(),
        r.realTime ? "real-time thread" : "ordinary thread (no permission for real time)", r.arenasGrown);
  }
  if (r.pauses.count > 0)
    text += fmt::format("{} pauses of the source, {:.1f} s in all\n", r.pauses.count, r.pauses.seconds);
  return text;
}

/// Prints it on stdout. @throws Error (failure) for what must not be missed
void reportRun(const FinishedRun& run, bool json) {
  const double seconds = static_cast<double>(run.report.steps) * run.stepSeconds;
  printResult(json, "record", runJson(run, seconds), runText(run, seconds));
  if (run.report.disagreements > 0) {
    throw Error(
        ErrorKind::failure,
        fmt::format("{}: {} ticks got other forces on the haptic thread than when computed again; the recording "
                    "will not replay",
                    run.file, run.report.disagreements));
  }
  if (run.report.runaway) {
    throw Error(ErrorKind::failure, fmt::format("{}: {}", run.file, analytics::wordsFor(*run.report.runaway)));
  }
}

/// Options of both commands.
struct RunOptions {
  SourceOptions source;
  std::string stationKey, output, broadPhase = "grid";
  std::uint64_t seed = 1;
  double seconds = 0.0;
  unsigned threads = 1;
  bool live = false, force = false, json = false;
};

/// Adds the last of them.
void addRunOptions(CLI::App& command, RunOptions& o, const std::string& output) {
  addBroadPhase(command, o.broadPhase);
  addThreads(command, o.threads, "of the simulation; 0: all");
  command.add_option("-o,--output", o.output, output)->required();
  command.add_flag("--force", o.force, "replace the output if it is there");
  command.add_flag("--json", o.json, "print the result as JSON");
}

void warnUnlocked(const recorder::RecordingWriter& writer, const std::string& output) {
  if (writer.locked()) return;
  Progress::erase();
  fmt::print(stderr, "calot: warning: {}: recorded without a lock, which its file system does not grant\n", output);
}

struct RecordOptions : RunOptions {
  std::string scene, participant, station, purpose = "training", handedness = "unknown", mode = "practice";
  bool paced = false;
};

void record(const RecordOptions& o) {
  if (!std::isfinite(o.seconds)) throw Error(ErrorKind::invalid, "--seconds: a number is expected");
  stopOnSignals();
  recorder::refuseOutput(o.output, o.force);
  std::optional<recorder::StationKey> key = stationKeyOf(o.stationKey);
  Progress progress("Preparing the scene", o.json);
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(o.scene, assetFolders()));
  if (!scene.warnings.empty()) Progress::erase();
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "calot: warning: {}\n", warning);
  const std::shared_ptr<recorder::PreparedScene> prepared =
      recorder::prepareScene(scene.assets, Where{"scene " + o.scene});
  const Model& model = prepared->model();
  SourceOptions who = o.source;
  who.mode = o.mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, model.scene(), o.seed);
  const recorder::AttemptHeader header =
      recorder::makeHeader(model, std::move(scene.assets), source->provenance(),
                           {o.participant, stationOf(o.station, key), o.purpose, o.handedness, who.mode, o.seed});
  recorder::WorkerPool pool(o.threads);
  recorder::Session session(model, o.seed, pool, prepared->services(broadPhaseOf(o.broadPhase)));
  const auto stopped = [&] {
    return Error(ErrorKind::failure, Where{o.output}, "stopped before its first step: nothing was recorded");
  };
  if (stopRequested()) throw stopped();
  // From here on --force has replaced what was there.
  recorder::RecordingWriter writer(o.output, header, {o.force, std::move(key)});
  warnUnlocked(writer, o.output);
  session.join(writer);
  progress.next("Recording", "s");
  recorder::RunSettings run{.seconds = o.seconds, .paced = o.paced, .live = o.live, .stop = &stopRequested()};
  driveDevice(*source, run);
  recordDevice(*source, writer);
  const double stepSeconds = model.stepSeconds();
  run.progress = [&](std::uint64_t step) {
    if (writer.failed()) stopRequested() = true;  // nothing more can be kept; finish() says why
    progress.show(static_cast<std::uint64_t>(static_cast<double>(step) * stepSeconds),
                  static_cast<std::uint64_t>(o.seconds));
  };
  const recorder::RunReport report = recorder::runAttempt(session, *source, run);
  writer.finish();
  prepared->save();
  Progress::erase();
  if (report.steps == 0 && report.outcome == recorder::Outcome::stopped) throw stopped();
  if (!o.json) printDevice(*source);
  reportRun({header.attempt, o.output, stepSeconds, report, source->statusText(), run.paced || o.live, o.live}, o.json);
}

struct BranchOptions : RunOptions {
  std::string parent, at;
};

/// Keeps the newest measured pose of each hand, and the camera.
class LastPose final : public recorder::Observer {
 public:
  void onStep(const recorder::StepRecord& record) override {
    for (const TickSamples& tick : record.samples) {
      for (std::size_t h = 0; h < handCount; ++h) {
        if (tick.hand[h].valid) last.hand[h] = tick.hand[h];
      }
      last.camera = tick.camera;
    }
  }
  void onEnd(recorder::Outcome /*outcome*/) override {}
  TickSamples last;
};

void branch(const BranchOptions& o) {
  if (!std::isfinite(o.seconds)) throw Error(ErrorKind::invalid, "--seconds: a number is expected");
  stopOnSignals();
  const double at = parseTime(o.at);
  Progress progress("Reading the parent", o.json);
  std::optional<recorder::StationKey> key = stationKeyOf(o.stationKey);
  recorder::NewFile file(o.output, o.force, ".branch");
  const recorder::ChainVerdict chain = recorder::probe(o.parent);
  recorder::Recording parent(o.parent);
  analytics::refuseBrokenParent(parent.path(), chain);
  recorder::refuseParent(parent);
  const std::uint64_t forkStep = recorder::forkStepAt(parent, at);
  const std::shared_ptr<recorder::PreparedScene> scene = recorder::sceneOf(parent);
  const Model& model = scene->model();
  const std::unique_ptr<recorder::SampleSource> source = makeSource(o.source, model.scene(), o.seed);
  recorder::AttemptHeader header = recorder::branchHeader(parent, model, forkStep, source->provenance());
  if (key) header.station = key->station;  // of who signs, wherever the parent came from

  recorder::RecordingWriter writer(file.path(), header, {true, std::move(key)});
  warnUnlocked(writer, o.output);
  recorder::WorkerPool pool(o.threads);
  recorder::Session session(model, header.seed, pool, scene->services(broadPhaseOf(o.broadPhase)));
  LastPose pose;
  session.join(writer);
  session.join(pose);
  {
    progress.next("Simulating the parent's steps", "steps");
    const auto divergence = recorder::takeParent(parent, session, forkStep, [&](std::uint64_t step, std::uint64_t of) {
      if (writer.failed()) {
        session.end(recorder::Outcome::technicalFailure);
        writer.finish();  // says why
      }
      if (stopRequested()) throw Error(ErrorKind::failure, fmt::format("{}: stopped before the fork", o.output));
      progress.show(step, of);
    });
    if (divergence) throw Error(ErrorKind::refused, Where{parent.path().string()}, analytics::wordsFor(*divergence));
  }
  file.publish();

  if (auto* const device = source->device(); device != nullptr) device->setOutFrom(pose.last);
  if (auto* const scope = source->scope(); scope != nullptr) scope->setOutFrom(pose.last.camera);
  recorder::BlendedSource blended(*source, pose.last);
  recorder::RunSettings run{.live = o.live, .stop = &stopRequested()};
  if (o.seconds > 0.0) run.seconds = static_cast<double>(session.steps()) * model.stepSeconds() + o.seconds;
  driveDevice(*source, run);
  recordDevice(*source, writer, session.steps() * model.scene().ticksPerStep);
  progress.next("Recording", "steps");
  run.progress = [&](std::uint64_t step) {
    if (writer.failed()) stopRequested() = true;  // nothing more can be kept; finish() says why
    progress.show(step, 0);
  };
  const recorder::RunReport report = recorder::runAttempt(session, blended, run);
  writer.finish();
  Progress::erase();
  if (!o.json) {
    fmt::print("{}: branch of {} after its step {}\n", o.output, header.parent, forkStep);
    printDevice(*source);
  }
  reportRun({header.attempt, o.output, model.stepSeconds(), report, source->statusText(), run.paced || o.live, o.live},
            o.json);
}

}  // namespace

void addRecord(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"record", "Runs an attempt and records it.",
                  "calot record --scene touch-liver --performer skilled --seed 7 -o attempt.h5",
                  "calot record --scene cholecystectomy --device gamepad --participant P1 -o attempt.h5"},
                 record);
  command->add_option("--scene", o->scene, "name of a scene (calot scenes), or a scene file")->required();
  addSource(*command, o->source);
  command->add_option("--seed", o->seed, "of performer and simulation")->check(wholeNumber)->capture_default_str();
  command->add_option("--seconds", o->seconds, "stop after so much attempt time; 0: when the source ends")
      ->check(CLI::Range(0.0, 36000.0));
  command->add_option("--participant", o->participant, "pseudonym")->transform(CLI::Validator(pseudonymForm, ""));
  command->add_option("--station", o->station, "name of this training station");
  addStationKey(*command, o->stationKey);
  addChoice(*command, "--purpose", o->purpose, "training, study, demo, golden",
            {"training", "study", "demo", "golden"});
  addChoice(*command, "--handedness", o->handedness, "right, left, unknown", {"right", "left", "unknown"});
  addChoice(*command, "--mode", o->mode, "practice or assessment", {"practice", "assessment"});
  command->add_flag("--paced", o->paced, "run at real time: tick n no earlier than n ms after the start");
  command->add_flag("--live", o->live, "run at real time with the haptic ticks on a thread of their own, 1 kHz");
  addRunOptions(*command, *o, "the recording");
}

void addBranch(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(app, run,
                                       {"branch", "Continues a recording from a chosen moment as a new recording.",
                                        "calot branch attempt.h5 --at 1:02.5 --performer skilled -o branch.h5"},
                                       branch);
  command->add_option("recording", o->parent, "the parent")->required();
  command->add_option("--at", o->at, "where the branch leaves it: seconds (12.5) or minutes and seconds (1:02.5)")
      ->required();
  addSource(*command, o->source);
  command->add_option("--seed", o->seed, "of a performer; the simulation keeps the parent's")
      ->check(wholeNumber)
      ->capture_default_str();
  command->add_option("--seconds", o->seconds, "stop so long after the fork; 0: when the source ends")
      ->check(CLI::Range(0.0, 36000.0));
  command->add_flag("--live", o->live, "run at real time after the fork, the haptic ticks on a thread of their own");
  addStationKey(*command, o->stationKey);
  addRunOptions(*command, *o, "the branch, a recording");
}

}  // namespace calot::apps

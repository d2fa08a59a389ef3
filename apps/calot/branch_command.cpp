// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/run_report.h"
#include "apps/calot/source_options.h"
#include "recorder/base/errors.h"
#include "recorder/branch.h"
#include "recorder/live/worker_pool.h"
#include "recorder/live/wrapped_sources.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/scope/scope_source.h"

namespace calot::apps {

namespace {

struct BranchOptions {
  SourceOptions source;
  std::string parent, at, stationKey, output, broadPhase = "grid";
  std::uint64_t seed = 1;
  double seconds = 0.0;
  unsigned threads = 1;
  bool live = false, force = false, json = false;
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

int branch(const BranchOptions& o) {
  if (!std::isfinite(o.seconds)) throw Error(ErrorKind::invalid, "--seconds: a number is wanted");
  stopOnSignals();
  const double at = parseTime(o.at);
  std::optional<recorder::StationKey> key = stationKeyOf(o.stationKey);
  recorder::BranchFile file(o.output, o.force);
  const recorder::ChainVerdict chain = recorder::probe(o.parent);
  recorder::Recording parent(o.parent);
  recorder::refuseParent(parent, chain);
  const std::uint64_t forkStep = recorder::forkStepAt(parent, at);
  const std::shared_ptr<recorder::PreparedScene> scene = recorder::sceneOf(parent);
  const Model& model = scene->model();
  const std::unique_ptr<recorder::SampleSource> source = makeSource(o.source, model.scene(), o.seed);
  recorder::AttemptHeader header = recorder::branchHeader(parent, model, forkStep, source->provenance());
  if (key) header.station = key->station;  // of who signs, wherever the parent came from

  recorder::RecordingWriter writer(file.path(), header, {true, std::move(key)});
  recorder::WorkerPool pool(o.threads);
  recorder::Session session(model, header.seed, pool, scene->services(broadPhaseOf(o.broadPhase)));
  LastPose pose;
  session.join(writer);
  session.join(pose);
  {
    Progress progress("taking the parent's steps", o.json);
    recorder::takeParent(parent, session, forkStep, [&](std::uint64_t step, std::uint64_t of) {
      if (writer.failed()) {
        session.end(recorder::Outcome::technicalFailure);
        writer.finish();  // says why
      }
      if (stopRequested()) throw Error(ErrorKind::failure, fmt::format("{}: stopped before the fork", o.output));
      progress.show(step, of);
    });
  }
  file.publish();

  if (auto* const scope = source->scope(); scope != nullptr) scope->setOutFrom(pose.last.camera);
  recorder::BlendedSource blended(*source, pose.last);
  recorder::RunSettings run;
  run.seconds = o.seconds > 0.0 ? static_cast<double>(session.steps()) * model.stepSeconds() + o.seconds : 0.0;
  run.live = o.live;
  driveDevice(*source, run);
  recordDevice(*source, writer, session.steps() * model.scene().ticksPerStep);
  run.stop = &stopRequested();
  Progress progress("recording, steps", o.json);
  run.progress = [&](std::uint64_t step) {
    if (writer.failed()) stopRequested() = true;  // nothing more can be kept; finish() says why
    progress.show(step, 0);
  };
  const recorder::RunReport report = recorder::runAttempt(session, blended, run);
  writer.finish();
  Progress::erase();
  if (!o.json) {
    fmt::print("{}: branch of {} after its step {}\n", o.output, header.parent, forkStep);
    tellDevice(*source);
  }
  return tell(
      {header.attempt, o.output, model.stepSeconds(), report, source->statusText(), run.paced || o.live, o.live},
      o.json);
}

}  // namespace

void addBranch(CLI::App& app, Run& run) {
  auto o = std::make_shared<BranchOptions>();
  CLI::App* command = app.add_subcommand("branch", "Goes back to a moment of a recording and on from there, recorded.");
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
  addBroadPhase(*command, o->broadPhase);
  command->add_option("--threads", o->threads, "of the simulation; 0: all")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_option("-o,--output", o->output, "the branch, a recording")->required();
  command->add_flag("--force", o->force, "replace the output if it is there");
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] { run = [o] { return branch(*o); }; });
}

}  // namespace calot::apps

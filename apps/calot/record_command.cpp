// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/run_report.h"
#include "apps/calot/source_options.h"
#include "apps/calot/wrong_word.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/writer.h"

namespace calot::apps {

namespace {

struct RecordOptions {
  SourceOptions source;
  std::string scene, participant, station, stationKey, purpose = "training", handedness = "unknown", output;
  std::string mode = "practice", broadPhase = "grid";
  std::uint64_t seed = 1;
  double seconds = 0.0;
  unsigned threads = 1;
  bool paced = false, live = false, force = false, json = false;
};

int record(const RecordOptions& o) {
  if (!std::isfinite(o.seconds)) throw Error(ErrorKind::invalid, "--seconds: a number is wanted");
  stopOnSignals();
  refuseExisting(o.output, o.force);
  std::optional<recorder::StationKey> key = stationKeyOf(o.stationKey);
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(o.scene, assetFolders()));
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "calot: warning: {}\n", warning);
  const std::shared_ptr<recorder::PreparedScene> prepared =
      recorder::prepareScene(scene.assets, Where{"scene " + o.scene});
  const Model& model = prepared->model();
  SourceOptions who = o.source;
  who.mode = o.mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, model.scene(), o.seed);
  recorder::AttemptSettings settings;
  settings.participant = o.participant;
  settings.station = stationOf(o.station, key);
  settings.purpose = o.purpose;
  settings.handedness = o.handedness;
  settings.mode = who.mode;
  settings.seed = o.seed;
  const recorder::AttemptHeader header =
      recorder::makeHeader(model, std::move(scene.assets), source->provenance(), settings);
  recorder::RecordingWriter writer(o.output, header, {o.force, std::move(key)});
  recorder::WorkerPool pool(o.threads);
  recorder::Session session(model, o.seed, pool, prepared->services(broadPhaseOf(o.broadPhase)));
  session.join(writer);
  Progress progress("recording, seconds", o.json);
  recorder::RunSettings run;
  run.seconds = o.seconds;
  run.paced = o.paced;
  run.live = o.live;
  driveDevice(*source, run);
  recordDevice(*source, writer);
  run.stop = &stopRequested();
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
  if (!o.json) tellDevice(*source);
  return tell({header.attempt, o.output, stepSeconds, report, source->statusText(), run.paced || o.live, o.live},
              o.json);
}

}  // namespace

void addRecord(CLI::App& app, Run& run) {
  auto o = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand("record", "Runs an attempt and records it.");
  command->add_option("--scene", o->scene, "name of a scene (calot scenes), or a scene file")->required();
  addSource(*command, o->source);
  command->add_option("--seed", o->seed, "of performer and simulation")->check(wholeNumber)->capture_default_str();
  command->add_option("--seconds", o->seconds, "stop after so much attempt time; 0: when the source ends")
      ->check(CLI::Range(0.0, 36000.0));
  command->add_option("--participant", o->participant, "pseudonym")->check([](const std::string& p) {
    return p.size() > 64 ? std::string("longer than 64 characters") : std::string();
  });
  command->add_option("--station", o->station, "name of this training station");
  addStationKey(*command, o->stationKey);
  command->add_option("--purpose", o->purpose, "training, study, demo, golden")
      ->check(oneOf({"training", "study", "demo", "golden"}))
      ->capture_default_str();
  command->add_option("--handedness", o->handedness, "right, left, unknown")
      ->check(oneOf({"right", "left", "unknown"}))
      ->capture_default_str();
  command->add_option("--mode", o->mode, "practice or assessment")
      ->check(oneOf({"practice", "assessment"}))
      ->capture_default_str();
  command->add_flag("--paced", o->paced, "run at real time: tick n no earlier than n ms after the start");
  command->add_flag("--live", o->live, "run at real time with the haptic ticks on a thread of their own, 1 kHz");
  addBroadPhase(*command, o->broadPhase);
  command->add_option("--threads", o->threads, "of the simulation; 0: all")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_option("-o,--output", o->output, "the recording")->required();
  command->add_flag("--force", o->force, "replace the output if it is there");
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] { run = [o] { return record(*o); }; });
}

}  // namespace calot::apps

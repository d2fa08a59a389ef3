// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/command.h"
#include "recorder/base/files.h"
#include "recorder/engine/state_fields.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/state_file.h"
#include "recorder/replay.h"
#include "sim/scene/flat.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

constexpr std::uint64_t flatSteps = 200;

struct StateOptions {
  std::string recording, output;
  std::uint64_t step = 0;
  bool flat = false, force = false, anyway = false;
};

void state(const StateOptions& o) {
  recorder::refuseOutput(o.output, o.force);
  Progress progress("Simulating to the step");
  recorder::probe(o.recording);
  recorder::Recording recording(o.recording);
  if (o.step >= recording.stepCount()) {
    throw Error(ErrorKind::invalid, fmt::format("{}: has steps 0 to {}, not {}", o.recording,
                                                static_cast<std::int64_t>(recording.stepCount()) - 1, o.step));
  }
  const std::uint32_t version = recording.header().simulationVersion;
  if (version != simulationVersion) {
    const std::string what =
        fmt::format("recorded with simulation version {}, this build has {}: its State is that of another attempt",
                    version, simulationVersion);
    if (!o.anyway) throw Error(ErrorKind::undecided, Where{o.recording}, what, {Remedy::replayAnyway});
    Progress::erase();
    std::cerr << "calot: warning: " << o.recording << ": " << what << '\n';
  }
  // This build can read the State of its own version only.
  const recorder::EngineChoice choice(recording, {.anyway = true});
  recorder::Seeker seeker(recording, choice);
  seeker.seek(o.step);
  const std::shared_ptr<recorder::PreparedScene> scene = recorder::sceneOf(recording);
  State state;
  const recorder::Keyframe keyframe = seeker.keyframe();
  if (!restoreState(scene->model(), keyframe.state, state))
    throw Error(ErrorKind::damaged, fmt::format("{}: the State of step {} cannot be restored", o.recording, o.step));
  if (!o.flat) {
    recorder::writeStateFile(o.output, o.step, simulationVersion, recorder::stateFields(scene->model(), state),
                             o.force);
    return;
  }
  FlatState flat;
  flat.scene = scene->model().scene();
  flat.state = keyframe.state;
  const std::uint64_t last = std::min(recording.stepCount(), o.step + 1 + flatSteps);
  for (std::uint64_t n = o.step + 1; n < last; ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    flat.ticks.insert(flat.ticks.end(), step.samples.begin(), step.samples.end());
  }
  const std::vector<std::byte> bytes = saveFlat(flat);
  recorder::writeText(o.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, o.force);
}

struct DiffOptions {
  std::string first, second;
  bool json = false;
};

ExitCode diff(const DiffOptions& o) {
  const recorder::StateFile a = recorder::readStateFile(o.first);
  const recorder::StateFile b = recorder::readStateFile(o.second);
  const auto difference = recorder::firstDifference(a.fields, b.fields);
  nlohmann::json json{{"equal", !difference}};
  std::string text = fmt::format("equal: {} fields of step {}\n", a.fields.size(), a.step);
  if (const auto& d = difference) {
    json.update({{"field", d->field}, {"index", d->index}, {"first", d->first}, {"second", d->second}});
    text = fmt::format("{} index {}: {} and {}\n", d->field, d->index, d->first, d->second);
  }
  if (a.step != b.step) text += fmt::format("the first is of step {}, the second of step {}\n", a.step, b.step);
  printResult(o.json, "diff", json, text);
  return difference ? ExitCode::no : ExitCode::yes;
}

}  // namespace

void addState(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(app, run,
                                       {"state", "Writes the State after a step, as HDF5 or as plain bytes.",
                                        "calot state attempt.h5 --step 100 -o step100.h5"},
                                       state);
  command->add_option("recording", o->recording, "recording")->required();
  command->add_option("--step", o->step, "the step after which")->check(wholeNumber)->required();
  command->add_flag("--flat", o->flat, "scene, State and the next 200 steps' samples as plain bytes, for the matrix");
  command->add_option("-o,--output", o->output, "file to write")->required();
  command->add_flag("--anyway", o->anyway, "what this build makes of a recording of another simulation version, too");
  command->add_flag("--force", o->force, "replace the output if it is there");
}

void addDiff(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"diff", "First field, index and both values that differ between two State files.",
                  "calot diff step100.h5 other.h5"},
                 diff);
  command->add_option("first", o->first, "file of `calot state`")->required();
  command->add_option("second", o->second, "file of `calot state`")->required();
  command->add_flag("--json", o->json, "print the result as JSON");
}

}  // namespace calot::apps

// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "analytics/checkpoints/replay_words.h"
#include "apps/calot/command.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/kept/transcript.h"
#include "recorder/recording/probe.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

namespace fs = std::filesystem;

const char* kindOf(const recorder::KeptEngine& engine) { return engine.isModule ? "module" : "program"; }

void listEngines(const JsonOption& o) {
  const std::vector<recorder::KeptEngine> engines = recorder::listEngines();
  nlohmann::json out = nlohmann::json::array();
  std::string text = fmt::format("this program decides simulation version {}\n", simulationVersion);
  for (const recorder::KeptEngine& e : engines) {
    out.push_back(
        {{"version", e.version}, {"kind", kindOf(e)}, {"file", e.file.string()}, {"runs", !e.command.empty()}});
    text += fmt::format("version {}: {} {}{}\n", e.version, kindOf(e), fs::weakly_canonical(e.file).string(),
                        e.command.empty() ? " (node is needed to run it)" : "");
  }
  if (engines.empty()) text += "no other engine was found (CALOT_ENGINES names folders that hold some)\n";
  printResult(o.json, "engines", {{"own_version", simulationVersion}, {"engines", out}}, text);
}

/// @return false where the engine is not what it should be; prints a line of each thing that was looked at
bool isSound(const recorder::KeptEngine& engine) {
  const auto say = [&](const std::string& what, const std::string& fault) {
    fmt::print("version {}, {}: {}: {}\n", engine.version, kindOf(engine), what, fault.empty() ? "ok" : fault);
    return fault.empty();
  };
  const std::string beside = fmt::format("engines/{}", engine.version);  // its transcript and golden recordings
  bool good = true;
  try {
    const recorder::EngineProcess process(engine.command, engine.version);
    static constexpr const char* confined[] = {"not confined", "confined by itself", "confined by its runtime"};
    good = say(fmt::format("{}, {}", process.identity().software,
                           confined[static_cast<std::size_t>(process.identity().confinement)]),
               "");
    for (const fs::path& file : listAssets(beside, ".transcript")) {
      good = say(file.filename().string(), compareWith(recorder::readTranscript(file), engine.command)) && good;
    }
  } catch (const Error& e) {
    return say("it", e.what());
  }
  for (const fs::path& golden : listAssets(beside, ".h5")) {
    recorder::ReplaySettings settings;
    settings.engine.file = engine.file;
    const recorder::ReplayReport report = recorder::replayRecording(golden, settings);
    const bool exact = report.verdict == recorder::ReplayVerdict::exact;
    good = say(golden.filename().string(), exact ? "" : analytics::wordsFor(report)) && good;
  }
  return good;
}

ExitCode checkEngines(const std::vector<std::uint32_t>& versions) {
  std::vector<recorder::KeptEngine> engines = recorder::listEngines();
  std::erase_if(engines, [&](const recorder::KeptEngine& e) {
    return !versions.empty() && std::find(versions.begin(), versions.end(), e.version) == versions.end();
  });
  for (const std::uint32_t version : versions) {
    if (std::none_of(engines.begin(), engines.end(), [&](const auto& e) { return e.version == version; }))
      throw Error(ErrorKind::invalid, fmt::format("no engine of version {} was found (calot engine list)", version));
  }
  bool good = true;
  for (const recorder::KeptEngine& e : engines) {
    if (e.command.empty()) {
      fmt::print("version {}, module: not run, for there is no node here\n", e.version);
      continue;
    }
    good = isSound(e) && good;
  }
  if (engines.empty()) fmt::print("no engine was found\n");
  return good ? ExitCode::yes : ExitCode::no;
}

struct BuildOptions {
  std::uint32_t version = 0;
  std::string output, source;
  bool module = false, force = false;
};

/// The script of a clone does it: no installed program holds the sources of old versions.
void build(const BuildOptions& o) {
  if (o.source.empty())
    throw Error(ErrorKind::invalid, "no clone of the source belongs to this program: name one with --source");
  const fs::path script = fs::path(o.source) / "scripts/engine.py";
  std::error_code ignored;
  if (!fs::is_regular_file(script, ignored))
    throw Error(ErrorKind::invalid, fmt::format("{} is not a clone of the source: name one with --source", o.source));
  recorder::refuseOutput(o.output, o.force);
  std::vector<std::string> command{"python3", script.string(), "build", std::to_string(o.version), "-o", o.output};
  if (o.module) command.emplace_back("--module");
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  throw Error(ErrorKind::failure, fmt::format("python3 cannot be started: {}", std::strerror(errno)));
}

struct TranscriptOptions {
  std::string recording, engine, output;
  std::uint64_t steps = 20;
  bool force = false;
};

void transcribe(const TranscriptOptions& o) {
  recorder::refuseOutput(o.output, o.force);
  recorder::probe(o.recording);
  recorder::Recording recording(o.recording);
  if (o.steps < 2 || o.steps > recording.stepCount())
    throw Error(ErrorKind::invalid,
                fmt::format("{}: has {}", o.recording, recorder::counted(recording.stepCount(), "step")));
  const std::vector<std::byte> bytes =
      bytesOf(recorder::makeTranscript(recorder::commandOf(o.engine), recording, o.steps));
  recorder::writeText(o.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, o.force);
}

}  // namespace

void addEngine(CLI::App& app, Run& run) {
  CLI::App& command = addGroup(
      app, {"engine", "Kept engines: programs that decide recordings of other versions.", "calot engine list"});

  const auto [listing, l] =
      addCommand(command, run, {"list", "Shows which engines are there.", "calot engine list --json"}, listEngines);
  listing->add_flag("--json", l->json, "print them as JSON");

  const auto [checking, versions] = addCommand(
      command, run,
      {"check", "Starts engines, compares their answers with their transcripts, and has them replay their goldens.",
       "calot engine check 12"},
      checkEngines);
  checking->add_option("versions", *versions, "simulation versions; none: every engine that is there");

  const auto [building, b] = addCommand(command, run,
                                        {"build", "Builds the engine of a version from a clone of the source.",
                                         "calot engine build 12 -o calot-engine-12"},
                                        build);
  b->source = recorder::ProgramFiles::ofThisProgram().clone().string();
  building->add_option("version", b->version, "simulation version")->required();
  building->add_option("-o,--output", b->output, "the engine's file")->required();
  building->add_option("--source", b->source,
                       "clone with the whole history; default: the one that this program was built in");
  building->add_flag("--module", b->module, "as a WebAssembly module");
  building->add_flag("--force", b->force, "overwrite the file");

  const auto [writing, t] =
      addCommand(command, run,
                 {"transcript", "Writes what an engine answers, for engine check.",
                  "calot engine transcript attempt.h5 --engine calot-engine-12 -o transcript.txt"},
                 transcribe);
  writing->add_option("recording", t->recording, "whose scene and first steps are asked")->required();
  writing->add_option("--engine", t->engine, "program or module")->required();
  writing->add_option("--steps", t->steps, "steps that it is to do")->capture_default_str();
  writing->add_option("-o,--output", t->output, "the transcript")->required();
  writing->add_flag("--force", t->force, "overwrite the file");
}

}  // namespace calot::apps

// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/golden_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/registry.h"
#include "analytics/report/report_text.h"
#include "apps/calot/environment.h"
#include "apps/calot/source_options.h"
#include "recorder/loop.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/text_output.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/writer.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::ObjectRule;

constexpr double maxSeconds = 36000.0;
constexpr double any = 1e300;
constexpr std::size_t maxBytes = 4U << 20U;

const ObjectRule rootRule{
    "", {{"simulation_version", true, 1, 4294967295.0}, {"reason"}, {"values_reason", false}, {"recordings"}}};
const ObjectRule recordingRule{"recording",
                               {{"file"},
                                {"scene"},
                                {"performer"},
                                {"seed", true, 0, 4294967295.0},
                                {"seconds", true, 0, maxSeconds},
                                {"checkpoints", false}}};
const ObjectRule valueRule{
    "value", {{"name"}, {"subject", false}, {"version", true, 1, 4294967295.0}, {"value", true, -any, any}}};

GoldenValue readValue(const JsonPlace& place) {
  const JsonObject o = place.object(valueRule);
  GoldenValue v;
  o.read("name", v.name, 100);
  o.read("subject", v.subject, 100);
  o.read("version", v.version);
  o.read("value", v.value);
  return v;
}

GoldenEntry readEntry(const JsonPlace& place) {
  const JsonObject o = place.object(recordingRule);
  GoldenEntry e;
  o.read("file", e.file, 100);
  o.read("scene", e.scene, 100);
  o.read("performer", e.performer, 100);
  o.read("seed", e.seed);
  o.read("seconds", e.seconds);
  if (e.file.empty() || e.file.front() == '.' || std::filesystem::path(e.file).filename() != e.file)
    o.at("file").fail("is no file's name: a name without folders is wanted");
  if (o.has("checkpoints")) {
    for (const JsonPlace& value : o.at("checkpoints").list(0, 1000)) e.values.push_back(readValue(value));
  }
  return e;
}

}  // namespace

GoldenList readGoldenList(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = recorder::readFileBytes(file, file.string(), maxBytes);
  const nlohmann::json json = recorder::parseStrictJson(bytes, file.string());
  const JsonObject root = JsonPlace(json, file.string()).object(rootRule);
  GoldenList list;
  root.read("simulation_version", list.simulationVersion);
  root.read("reason", list.reason, 1000);
  root.read("values_reason", list.valuesReason, 1000);
  std::set<std::string> names;
  for (const JsonPlace& place : root.at("recordings").list(1, 1000)) {
    list.recordings.push_back(readEntry(place));
    if (!names.insert(list.recordings.back().file).second) place.fail("names a file that stands above already");
  }
  return list;
}

std::string toJson(const GoldenList& list) {
  nlohmann::ordered_json json;
  json["simulation_version"] = list.simulationVersion;
  json["reason"] = list.reason;
  if (!list.valuesReason.empty()) json["values_reason"] = list.valuesReason;
  json["recordings"] = nlohmann::ordered_json::array();
  for (const GoldenEntry& e : list.recordings) {
    nlohmann::ordered_json row;
    row["file"] = e.file;
    row["scene"] = e.scene;
    row["performer"] = e.performer;
    row["seed"] = e.seed;
    row["seconds"] = e.seconds;
    row["checkpoints"] = nlohmann::ordered_json::array();
    for (const GoldenValue& v : e.values) {
      nlohmann::ordered_json value = {{"name", v.name}};
      if (!v.subject.empty()) value["subject"] = v.subject;
      value["version"] = v.version;
      value["value"] = v.value;
      row["checkpoints"].push_back(value);
    }
    json["recordings"].push_back(row);
  }
  return json.dump(1) + "\n";
}

namespace {

std::string shown(const GoldenValue& v) {
  const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(v.name);
  if (definition == nullptr) return fmt::format("{}", v.value);
  return fmt::format("{} {}", analytics::significant(v.value * definition->displayFactor, 8), definition->displayUnit);
}

const GoldenValue* sameOf(const std::vector<GoldenValue>& values, const GoldenValue& of) {
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const GoldenValue& v) { return v.name == of.name && v.subject == of.subject; });
  return found == values.end() ? nullptr : &*found;
}

std::string titleOf(const GoldenValue& v) { return v.subject.empty() ? v.name : v.name + " " + v.subject; }

bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

}  // namespace

std::vector<GoldenValue> goldenValues(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<GoldenValue> kept;
  for (const analytics::CheckpointValue& v : values) {
    if (v.value) kept.push_back({v.name, v.subject, v.version, *v.value});
  }
  return kept;
}

std::vector<std::string> changedValues(const std::vector<GoldenValue>& before, const std::vector<GoldenValue>& now) {
  std::vector<std::string> lines;
  for (const GoldenValue& b : before) {
    const GoldenValue* n = sameOf(now, b);
    if (n == nullptr) {
      lines.push_back(fmt::format("{}: {} -> none", titleOf(b), shown(b)));
    } else if (!sameBits(n->value, b.value)) {
      const std::string why =
          n->version == b.version ? "" : fmt::format(" (definition version {} -> {})", b.version, n->version);
      lines.push_back(fmt::format("{}: {} -> {}{}", titleOf(b), shown(b), shown(*n), why));
    }
  }
  for (const GoldenValue& n : now) {
    if (sameOf(before, n) == nullptr) lines.push_back(fmt::format("{}: none -> {}", titleOf(n), shown(n)));
  }
  return lines;
}

GoldenReplay replayGolden(const std::filesystem::path& file, const GoldenEntry& entry, unsigned threads) {
  GoldenReplay replay;
  std::unique_ptr<analytics::CheckpointCollector> collector;
  recorder::ReplaySettings settings;
  settings.threads = threads;
  settings.observers = [&](const recorder::AttemptHeader& h, const SceneDescription& scene) {
    collector = std::make_unique<analytics::CheckpointCollector>(h, scene);
    return std::vector<recorder::Observer*>{collector.get()};
  };
  replay.report = recorder::replayRecording(file, settings);
  if (replay.report.verdict != recorder::ReplayVerdict::exact) return replay;
  replay.values = goldenValues(collector->values());
  replay.changed = changedValues(entry.values, replay.values);
  if (replay.changed.empty()) return replay;
  // The simulation is the same; what is computed over it is not.
  replay.report.verdict = recorder::ReplayVerdict::diverged;
  replay.report.message =
      fmt::format("bit-exact, but {} checkpoints have other values: {}", replay.changed.size(), replay.changed.front());
  return replay;
}

void refuseValues(const GoldenEntry& entry, const std::vector<GoldenValue>& now) {
  for (const GoldenValue& before : entry.values) {
    const GoldenValue* after = sameOf(now, before);
    const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(before.name);
    if (after != nullptr ? sameBits(after->value, before.value) || after->version > before.version
                         : definition == nullptr || definition->version > before.version)
      continue;
    throw Error(ErrorKind::refused,
                fmt::format("golden: {}: {} has another value ({} -> {}) and still definition version "
                            "{}: raise the version or mend the checkpoint",
                            entry.file, titleOf(before), shown(before), after == nullptr ? "none" : shown(*after),
                            before.version));
  }
}

namespace {

constexpr const char* listName = "golden.json";

/// What git prints, or nothing where it fails or is not there.
std::optional<std::string> git(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"git"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "git", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; failed == 0 && (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  if (failed != 0 || waitpid(child, &status, 0) != child || status != 0) return std::nullopt;
  return text;
}

GoldenEntry recordEntry(const GoldenEntry& entry, const std::filesystem::path& file) {
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(entry.scene, assetFolders()));
  const Model::Built built = Model::build(scene.description);
  if (!built.model) throw Error(ErrorKind::damaged, fmt::format("scene {}: {}", entry.scene, built.error));
  SourceOptions who;
  who.performer = entry.performer;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, built.model->scene(), entry.seed);
  recorder::AttemptSettings settings;
  settings.purpose = "golden";
  settings.seed = entry.seed;
  const recorder::AttemptHeader header =
      recorder::makeHeader(*built.model, std::move(scene.assets), source->provenance(), settings);
  recorder::RecordingWriter writer(file, header, {true});
  analytics::CheckpointCollector collector(header, built.model->scene());
  recorder::WorkerPool pool(1);
  recorder::Session session(*built.model, entry.seed, pool);
  session.join(writer);
  session.join(collector);
  recorder::RunSettings run;
  run.seconds = entry.seconds;
  run.stop = &stopRequested();
  recorder::runAttempt(session, *source, run);
  writer.finish();
  if (stopRequested()) throw Error(ErrorKind::failure, "golden: stopped; nothing was replaced");
  GoldenEntry made = entry;
  made.values = goldenValues(collector.values());
  return made;
}

/// Removes what was made and not taken over.
struct Temporary {
  std::vector<std::filesystem::path> files;
  ~Temporary() {
    std::error_code ignored;
    for (const std::filesystem::path& file : files) std::filesystem::remove(file, ignored);
  }
};

}  // namespace

const std::string& requiredReason(const std::string& reason) {
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    throw Error(ErrorKind::invalid, "golden: --reason: say why the recordings or their values change");
  return reason;
}

void refuseUpdate(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason) {
  requiredReason(reason);
  const bool complete = std::all_of(list.recordings.begin(), list.recordings.end(),
                                    [&](const GoldenEntry& e) { return std::filesystem::exists(folder / e.file); });
  if (complete && list.simulationVersion >= simulationVersion) {
    throw Error(ErrorKind::invalid,
                fmt::format("golden: the recordings are of simulation version {} and so is this build: what changes "
                            "them raises simulationVersion (sim/scene/version.h) first",
                            list.simulationVersion));
  }
  // Of the whole work tree, but for the recordings themselves: their header names a revision.
  const std::optional<std::string> changes =
      git({"-C", folder.string(), "status", "--porcelain", "--", ":/", ":(exclude)."});
  if (!changes) {
    throw Error(ErrorKind::invalid, fmt::format("golden: {} lies in no git work tree, or git is not there: golden "
                                                "recordings belong to a revision",
                                                folder.string()));
  }
  if (!changes->empty()) {
    throw Error(ErrorKind::invalid, fmt::format("golden: the work tree has changes ({}): commit them first",
                                                changes->substr(0, changes->find('\n'))));
  }
}

void updateGolden(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason,
                  const std::function<void(const GoldenEntry& before, const GoldenEntry& now)>& told) {
  GoldenList made;
  made.simulationVersion = simulationVersion;
  made.reason = reason;
  Temporary temporary;
  for (const GoldenEntry& entry : list.recordings) {
    temporary.files.push_back(folder / ("new." + entry.file));
    made.recordings.push_back(recordEntry(entry, temporary.files.back()));
    told(entry, made.recordings.back());
  }
  for (std::size_t i = 0; i < made.recordings.size(); ++i)
    std::filesystem::rename(temporary.files[i], folder / made.recordings[i].file);
  temporary.files.clear();
  recorder::writeText(folder / listName, toJson(made), true);
}

}  // namespace calot::apps

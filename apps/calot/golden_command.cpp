// SPDX-License-Identifier: GPL-3.0-or-later
// calot golden: recordings that every build of their simulation version must replay bit for bit.
// assets/golden/golden.json says how each is made and gives the values of its checkpoints; docs/how-to/golden.md says
// how to review a change of it.

#include <algorithm>
#include <bit>
#include <cstdio>
#include <set>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/source_options.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/record_reader.h"
#include "recorder/base/record_writer.h"
#include "recorder/base/text_output.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "sim/math/record.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

constexpr const char* listName = "golden.json";

/// A checkpoint's value when the recording was made; in SI units.
struct GoldenValue {
  std::string name, subject;
  std::uint32_t version = 0;  ///< of the checkpoint's definition
  double value = 0.0;
  static std::vector<Field> fields();
  bool operator==(const GoldenValue&) const = default;
};

/// One recording and how to make it: a performer in a scene, for at most `seconds`.
struct GoldenEntry {
  std::string file;  ///< base name, beside the list
  std::string scene, performer;
  std::uint32_t seed = 1;
  double seconds = 0.0;  ///< 0: until the performer ends
  std::vector<GoldenValue> values;

  static std::vector<Field> fields();
};

struct GoldenList {
  std::uint32_t simulationVersion = 0;  ///< of all recordings
  std::string reason;                   ///< why they were made again
  std::string valuesReason;             ///< why values were taken over since; empty: they were not
  std::vector<GoldenEntry> recordings;

  static std::vector<Field> fields();
};

constexpr std::size_t maxBytes = 4U << 20U;
constexpr Range whole = within(0, 4294967295.0), positive = within(1, 4294967295.0), any = within(-1e300, 1e300);
constexpr TextRule shortText{100}, longText{1000};

std::vector<Field> GoldenValue::fields() {
  using S = GoldenValue;
  return {
      object("value", "Value of a checkpoint"),
      {"name", at<S, &S::name>, shortText, "Checkpoint"},
      optional("subject", at<S, &S::subject>, shortText, "Subject"),
      {"version", at<S, &S::version>, "", positive, "Version of its definition"},
      {"value", at<S, &S::value>, "", any, "Value"},
  };
}

std::vector<Field> GoldenEntry::fields() {
  using S = GoldenEntry;
  return {
      object("recording", "Golden recording"),
      {"file", at<S, &S::file>, shortText, "Base name"},
      {"scene", at<S, &S::scene>, shortText, "Scene"},
      {"performer", at<S, &S::performer>, shortText, "Performer"},
      {"seed", at<S, &S::seed>, "", whole, "Seed"},
      {"seconds", at<S, &S::seconds>, "s", within(0, 36000), "Longest duration"},
      optional("checkpoints", at<S, &S::values>, "Values of checkpoints").items(0, 1000),
  };
}

std::vector<Field> GoldenList::fields() {
  using S = GoldenList;
  return {
      object("", "Golden recordings"),
      {"simulation_version", at<S, &S::simulationVersion>, "", positive, "Simulation version of all recordings"},
      {"reason", at<S, &S::reason>, longText, "Reason to make them again"},
      optional("values_reason", at<S, &S::valuesReason>, longText, "Reason to take over values since"),
      Field("recordings", at<S, &S::recordings>, "Recordings").items(1, 1000),
  };
}

/// @throws Error (damaged) naming file and place; a name of a file that is no base name, or is given twice, is refused.
GoldenList readGoldenList(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = recorder::readFileBytes(file, file.string(), maxBytes);
  const nlohmann::json json = recorder::parseStrictJson(bytes, file.string());
  const recorder::JsonPlace root(json, file.string());
  GoldenList list;
  recorder::readRecord(root, list);
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.recordings.size(); ++i) {
    const recorder::JsonPlace place = root.at("recordings").at(i);
    const std::string& base = list.recordings[i].file;
    if (base.front() == '.' || std::filesystem::path(base).filename() != base)
      place.at("file").fail("is not a file's name: a name without folders is expected");
    if (!names.insert(base).second) place.fail("names a file that stands above already");
  }
  return list;
}

/// The list as JSON; every number reads back as the same bits.
std::string toJson(const GoldenList& list) {
  Json json = recorder::writeRecord(list);
  const auto omitEmpty = [](Json& row, const char* name) {
    if (row[name] == "") row.erase(name);
  };
  omitEmpty(json, "values_reason");
  for (Json& recording : json["recordings"]) {
    for (Json& value : recording["checkpoints"]) omitEmpty(value, "subject");
  }
  return json.dump(1) + "\n";
}

std::string shownValue(const GoldenValue& v) {
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

/// The values that there are.
std::vector<GoldenValue> goldenValues(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<GoldenValue> kept;
  for (const analytics::CheckpointValue& v : values) {
    if (v.value) kept.push_back({v.name, v.subject, v.version, *v.value});
  }
  return kept;
}

/// One line for each checkpoint whose value differs in a bit, "path-length left: 123.4 mm -> 125.0 mm".
std::vector<std::string> changedValues(const std::vector<GoldenValue>& before, const std::vector<GoldenValue>& now) {
  std::vector<std::string> lines;
  for (const GoldenValue& b : before) {
    const GoldenValue* n = sameOf(now, b);
    if (n == nullptr) {
      lines.push_back(fmt::format("{}: {} -> none", titleOf(b), shownValue(b)));
    } else if (!sameBits(n->value, b.value)) {
      const std::string why =
          n->version == b.version ? "" : fmt::format(" (definition version {} -> {})", b.version, n->version);
      lines.push_back(fmt::format("{}: {} -> {}{}", titleOf(b), shownValue(b), shownValue(*n), why));
    }
  }
  for (const GoldenValue& n : now) {
    if (sameOf(before, n) == nullptr) lines.push_back(fmt::format("{}: none -> {}", titleOf(n), shownValue(n)));
  }
  return lines;
}

/// A replay of a golden recording.
struct GoldenReplay {
  recorder::ReplayReport report;
  std::vector<GoldenValue> values;   ///< where it is bit-exact
  std::vector<std::string> changed;  ///< changedValues() from the list's; the verdict is then `diverged`
};

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

/// A changed value needs a definition of a higher version, a value that is gone a checkpoint that is gone.
/// @throws Error (refused) naming the first value that changed without its definition.
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
                            entry.file, titleOf(before), shownValue(before),
                            after == nullptr ? "none" : shownValue(*after), before.version));
  }
}

/// Changes of a work tree outside of this folder; nothing where git fails or is not there.
std::optional<std::string> changesOutside(const std::filesystem::path& folder) {
  std::string quoted;
  for (const char c : folder.string()) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  const std::string command = "git -C '" + quoted + "' status --porcelain -- :/ ':(exclude).' 2>/dev/null";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  return pclose(pipe) == 0 ? std::optional(text) : std::nullopt;
}

GoldenEntry recordEntry(const GoldenEntry& entry, const std::filesystem::path& file) {
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(entry.scene, assetFolders()));
  const Model::Built built = Model::build(scene.description);
  if (!built.model) throw Error(ErrorKind::damaged, fmt::format("scene {}: {}", entry.scene, built.error));
  SourceOptions who;
  who.performer = entry.performer;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, built.model->scene(), entry.seed);
  const recorder::AttemptHeader header = recorder::makeHeader(
      *built.model, std::move(scene.assets), source->provenance(), {.purpose = "golden", .seed = entry.seed});
  recorder::RecordingWriter writer(file, header, {true});
  analytics::CheckpointCollector collector(header, built.model->scene());
  recorder::WorkerPool pool(1);
  recorder::Session session(*built.model, entry.seed, pool);
  session.join(writer);
  session.join(collector);
  recorder::runAttempt(session, *source, {.seconds = entry.seconds, .stop = &stopRequested()});
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

/// The reason given. @throws Error (invalid) where it is empty.
const std::string& requiredReason(const std::string& reason) {
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    throw Error(ErrorKind::invalid, "golden: --reason: say why the recordings or their values change");
  return reason;
}

/// @throws Error (invalid): the reason is empty; or all recordings are there and of this build's simulation version; or
/// `folder` is in no work tree, or in one with changes outside of it.
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
  const std::optional<std::string> changes = changesOutside(folder);  // a recording's header names a revision
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

struct GoldenOptions {
  std::string folder, reason, only;
  JunitOptions junit;
  unsigned threads = 1;
  bool json = false;
};

std::filesystem::path folderOf(const GoldenOptions& o) {
  if (!o.folder.empty()) return o.folder;
  for (const std::filesystem::path& root : assetFolders()) {
    if (std::filesystem::exists(root / "golden" / listName)) return root / "golden";
  }
  throw Error(ErrorKind::damaged, "golden: no asset folder holds golden/golden.json: name one with --folder");
}

void printLines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("    {}\n", line);
}

void printChanges(const std::string& file, std::size_t checkpoints, const std::vector<std::string>& changed) {
  fmt::print("{}: {} checkpoints, {} changed\n", file, checkpoints, changed.size());
  printLines(changed);
  std::fflush(stdout);
}

ExitCode checkGolden(const GoldenOptions& o) {
  const std::filesystem::path folder = folderOf(o);
  const GoldenList list = readGoldenList(folder / listName);
  if (!o.junit.file.empty()) recorder::refuseOutput(o.junit.file, o.junit.force);
  std::vector<recorder::ReplayReport> reports;
  nlohmann::json rows = nlohmann::json::array();
  Progress progress("replaying, recordings", o.json);
  for (const GoldenEntry& entry : list.recordings) {
    if (!o.only.empty() && entry.file != o.only) continue;
    const GoldenReplay checked = replayGolden(folder / entry.file, entry, o.threads);
    reports.push_back(checked.report);
    progress.show(reports.size(), list.recordings.size());
    if (o.json) {
      nlohmann::json row = reportJson(checked.report);
      row["changed_checkpoints"] = checked.changed;
      rows.push_back(row);
    } else {
      printReport(checked.report);
      printLines(checked.changed);
    }
  }
  if (reports.empty()) throw Error(ErrorKind::invalid, fmt::format("golden: --only {}: not in the list", o.only));
  Progress::erase();
  writeJunit(o.junit, "calot golden check", reports);
  if (o.json) printResult("golden-check", {{"recordings", rows}});
  return worstOf(reports);
}

ExitCode takeValues(const GoldenOptions& o) {
  const std::filesystem::path folder = folderOf(o);
  GoldenList list = readGoldenList(folder / listName);
  list.valuesReason = requiredReason(o.reason);
  Progress progress("replaying, recordings", false);
  for (std::size_t i = 0; i < list.recordings.size(); ++i) {
    GoldenEntry& entry = list.recordings[i];
    const GoldenReplay replay = replayGolden(folder / entry.file, entry, o.threads);
    progress.show(i + 1, list.recordings.size());
    // Only where the simulation does what it did are the checkpoints all that changed.
    if (replay.report.verdict != recorder::ReplayVerdict::exact && replay.changed.empty()) {
      printReport(replay.report);
      return worstOf({replay.report});
    }
    refuseValues(entry, replay.values);
    Progress::erase();
    printChanges(entry.file, replay.values.size(), replay.changed);
    entry.values = replay.values;
  }
  recorder::writeText(folder / listName, toJson(list), true);
  return ExitCode::yes;
}

/// Runs every recording of the list again, then replaces files and list together. @throws Error with nothing replaced.
void updateGolden(const GoldenOptions& o) {
  stopOnSignals();
  const std::filesystem::path folder = folderOf(o);
  const GoldenList list = readGoldenList(folder / listName);
  refuseUpdate(folder, list, o.reason);
  GoldenList made{simulationVersion, o.reason, {}, {}};
  Temporary temporary;
  for (const GoldenEntry& entry : list.recordings) {
    temporary.files.push_back(folder / ("new." + entry.file));
    const GoldenEntry& now = made.recordings.emplace_back(recordEntry(entry, temporary.files.back()));
    printChanges(now.file, now.values.size(), changedValues(entry.values, now.values));
  }
  for (std::size_t i = 0; i < made.recordings.size(); ++i)
    std::filesystem::rename(temporary.files[i], folder / made.recordings[i].file);
  temporary.files.clear();
  recorder::writeText(folder / listName, toJson(made), true);
}

}  // namespace

void addGolden(CLI::App& app, Run& run) {
  CLI::App& command =
      addGroup(app, {"golden", "Recordings that every build must replay bit for bit.", "calot golden check"});
  const auto o = std::make_shared<GoldenOptions>();
  const auto add = [&](const CommandText& text, auto work) {
    CLI::App* const one = addCommand(command, run, text, work, o).first;
    one->add_option("--folder", o->folder, "with golden.json; default: golden/ of the assets");
    return one;
  };
  CLI::App* checking = add({"check", "Replays them; compares checkpoints with those of the list.",
                            "calot golden check --junit golden.xml", "calot golden check --folder my-golden"},
                           checkGolden);
  CLI::App* updating = add({"update", "Records them again, after a change of the simulation.",
                            "calot golden update --reason \"contact solver: other tolerance\""},
                           updateGolden);
  CLI::App* values = add({"values", "Replays them; the list takes over what the checkpoints give.",
                          "calot golden values --reason \"new checkpoint\""},
                         takeValues);
  checking->add_option("--only", o->only, "one file of the list");
  for (CLI::App* one : {checking, values}) addThreads(*one, o->threads, "of the simulation; 0: all");
  addJunitOptions(*checking, o->junit);
  checking->add_flag("--json", o->json, "print the result as JSON");
  for (CLI::App* one : {updating, values})
    one->add_option("--reason", o->reason, "why they change; kept in the list")->required();
}

}  // namespace calot::apps

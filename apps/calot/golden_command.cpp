// SPDX-License-Identifier: GPL-3.0-or-later
// calot golden: recordings that every build of their simulation version must replay bit for bit, and long runs kept as
// digests, which a performer must repeat.
// assets/golden/golden.json says how each is made and gives the values of its checkpoints; docs/how-to/golden.md says
// how to review a change of it.

#include <algorithm>
#include <cstdio>
#include <list>
#include <set>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/source_options.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/block.h"
#include "recorder/recording/writer.h"
#include "sim/math/record.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

constexpr const char* listName = "golden.json";

/// A checkpoint's value when the recording was made; in SI units.
struct GoldenValue {
  std::string name;
  std::optional<std::string> subject;
  std::uint32_t version = 0;  ///< of the checkpoint's definition
  double value = 0.0;
  static std::vector<Field> fields();
  bool operator==(const GoldenValue&) const = default;
};

/// One golden and how to make it: a performer in a scene, for at most `seconds`.
struct GoldenEntry {
  std::string file;  ///< base name, beside the list: a recording (.h5), or digests (.json)
  std::string scene, performer;
  std::uint32_t seed = 1;
  double seconds = 0.0;  ///< 0: until the performer ends
  std::vector<GoldenValue> values;

  [[nodiscard]] bool isDigests() const { return file.ends_with(".json"); }
  static std::vector<Field> fields();
};

struct GoldenList {
  std::uint32_t simulationVersion = 0;      ///< of all recordings
  std::string reason;                       ///< why they were made again
  std::optional<std::string> valuesReason;  ///< why values were taken over since
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

/// @throws Error (damaged) naming file and place
nlohmann::json readJson(const std::filesystem::path& file) {
  return recorder::parseStrictJson(recorder::readFileBytes(file, file.string(), maxBytes), file.string());
}

/// @throws Error as readJson(); a name of a file that is no base name, or is given twice, is refused.
GoldenList readGoldenList(const std::filesystem::path& file) {
  const nlohmann::json json = readJson(file);
  const recorder::JsonPlace root(json, file.string());
  GoldenList list;
  recorder::readRecord(root, list);
  std::set<std::string> names{listName};
  for (std::size_t i = 0; i < list.recordings.size(); ++i) {
    const recorder::JsonPlace place = root.at("recordings").at(i);
    const std::string& base = list.recordings[i].file;
    if (base.front() == '.' || std::filesystem::path(base).filename() != base)
      place.at("file").fail("is not a file's name: a name without folders is expected");
    if (!names.insert(base).second) place.fail("names a file that stands above already");
  }
  return list;
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

std::string titleOf(const GoldenValue& v) { return v.subject ? v.name + " " + *v.subject : v.name; }

/// The values that there are.
std::vector<GoldenValue> goldenValues(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<GoldenValue> kept;
  for (const analytics::CheckpointValue& v : values) {
    if (!v.value) continue;
    kept.push_back({v.name, std::nullopt, v.version, *v.value});
    if (!v.subject.empty()) kept.back().subject = v.subject;
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
    } else if (n->value != b.value) {
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

/// A chain of XXH3-64: each link digests the one before and what a step adds. A line of text holds 100 links: the last
/// 4 hexadecimal digits of each, and all 16 of the line's last and of the run's.
struct DigestChain {
  static constexpr std::size_t stepsPerLine = 100, digits = 4, shortLinks = digits * (stepsPerLine - 1);
  std::uint64_t link = 0;
  std::vector<std::string> lines;

  void add(std::uint64_t digest, bool last = false) {
    const std::array<std::uint64_t, 2> both{link, digest};
    link = digest64(std::as_bytes(std::span(both)));
    if (lines.empty() || lines.back().size() > shortLinks) lines.emplace_back();
    const bool whole = last || lines.back().size() == shortLinks;
    lines.back() += whole ? fmt::format("{:016x}", link) : fmt::format("{:04x}", link & 0xFFFFU);
  }
};

/// First step of which two chains have other links; none: they are the same.
std::optional<std::uint64_t> firstDifference(const recorder::JsonPlace& kept, const recorder::JsonPlace& now) {
  constexpr std::size_t line = DigestChain::shortLinks + 16, lastOfLine = DigestChain::stepsPerLine - 1;
  const auto joined = [](const recorder::JsonPlace& lines) {
    std::string text;
    for (const recorder::JsonPlace& place : lines.list(1, 100000)) text += place.text(line);
    return text;
  };
  const std::string before = joined(kept), after = joined(now);
  if (before == after) return std::nullopt;
  const auto differing = std::mismatch(before.begin(), before.end(), after.begin(), after.end());
  const auto at = static_cast<std::size_t>(differing.first - before.begin());
  return at / line * DigestChain::stepsPerLine + std::min(at % line / DigestChain::digits, lastOfLine);
}

/// Digests a run: each step's samples, as State digests them, apart from what comes of them.
struct RunDigests final : recorder::Observer {
  const DigestLayout& layout;
  DigestChain samples, steps;

  explicit RunDigests(const DigestLayout& of) : layout(of) {}
  void onStep(const recorder::StepRecord& record) override {
    std::vector<std::byte> given, made;
    for (std::size_t f = 0; f < layout.fields.size(); ++f) {
      const std::string& name = layout.fields[f].name;
      if (name.ends_with("/samples") || name.ends_with("/inputs")) recorder::appendValue(given, record.digest.field[f]);
    }
    for (const std::uint64_t component : record.digest.component) recorder::appendValue(made, component);
    recorder::appendValue(made, recorder::forceDigest(record.ticks));
    for (const Event& event : record.result.events) recorder::appendRow(event, made);
    samples.add(digest64(given));
    steps.add(digest64(made));
  }
  void onEnd(recorder::Outcome outcome) override {
    for (DigestChain* chain : {&samples, &steps}) chain->add(static_cast<std::uint64_t>(outcome), true);
  }
};

/// A golden, replayed or run again.
struct GoldenReplay {
  recorder::ReplayReport report;
  std::vector<GoldenValue> values;   ///< of a replay, where it is bit-exact
  std::vector<std::string> changed;  ///< changedValues() from the list's; the verdict is then `diverged`
  Json digests;                      ///< of a run: as the golden's file has them, but for the reason
};

/// Runs a golden's performer. @param recording where it is recorded, or empty @throws Error; (failure) where it was
/// stopped
GoldenReplay perform(const GoldenEntry& entry, const std::filesystem::path& recording, unsigned threads) {
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(entry.scene, assetFolders()));
  const auto prepared = recorder::prepareScene(scene.assets, Where{"scene " + entry.scene});
  const Model& model = prepared->model();
  SourceOptions who;
  who.performer = entry.performer;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, model.scene(), entry.seed);
  const recorder::AttemptHeader header = recorder::makeHeader(model, std::move(scene.assets), source->provenance(),
                                                              {.purpose = "golden", .seed = entry.seed});
  RunDigests digests(header.layout);
  analytics::CheckpointCollector collector(header, model.scene());
  recorder::WorkerPool pool(threads);
  recorder::Session session(model, entry.seed, pool, prepared->services());
  std::optional<recorder::RecordingWriter> writer;
  if (!recording.empty()) session.join(writer.emplace(recording, header, recorder::WriterOptions{true}));
  session.join(digests);
  session.join(collector);
  const recorder::RunReport report =
      recorder::runAttempt(session, *source, {.seconds = entry.seconds, .stop = &stopRequested()});
  if (writer) writer->finish();
  if (stopRequested()) throw Error(ErrorKind::failure, "golden: stopped; nothing was replaced");
  prepared->save();
  std::string files;
  for (const recorder::Asset& asset : header.assets)
    files += fmt::format("{} {}\n", recorder::sha256Hex(asset.bytes), asset.name);
  GoldenReplay made;
  made.digests = {
      {"simulation_version", simulationVersion},
      {"build", header.build},
      {"scene", fmt::format("{}, SHA-256 {}", entry.scene, recorder::sha256Hex(std::as_bytes(std::span(files))))},
      {"performer", fmt::format("{} {}, seed {}", entry.performer, header.provenance.profileVersion, entry.seed)},
      {"samples", digests.samples.lines},
      {"steps", digests.steps.lines}};
  made.values = goldenValues(collector.values());
  made.report.complete = true;
  made.report.chain.emplace();
  made.report.steps = report.steps;
  made.report.seconds = static_cast<double>(report.steps) * model.stepSeconds();
  made.report.wallSeconds = report.wallSeconds;
  made.report.misses = report.misses;
  made.report.simulationVersion = simulationVersion;
  return made;
}

/// The verdict of a run: its steps changed, or else what they were made of, scene or performer.
/// @param file with the golden's digests @throws Error (damaged)
void judge(GoldenReplay& run, const std::filesystem::path& file) {
  const nlohmann::json before = readJson(file), after = run.digests;
  const recorder::JsonPlace kept(before, file.string()), now(after, file.string());
  const auto samples = firstDifference(kept.at("samples"), now.at("samples"));
  const auto steps = firstDifference(kept.at("steps"), now.at("steps"));
  const auto wasAndIs = [&](const char* key) {
    return fmt::format("({} -> {})", kept.at(key).text(1000), now.at(key).text(1000));
  };
  recorder::ReplayReport& report = run.report;
  report.path = file;
  report.verdict = recorder::ReplayVerdict::diverged;
  if (const auto version = kept.at("simulation_version").integer(positive); version != simulationVersion) {
    report.verdict = recorder::ReplayVerdict::undecided;
    report.error = fmt::format("made by simulation version {}; this build has {}", version, simulationVersion);
  } else if (kept.at("scene").text(1000) != now.at("scene").text(1000)) {
    report.divergence = {0, {}, "scene", "files", ""};
    report.error = "the scene changed " + wasAndIs("scene");
  } else if (steps && (!samples || *steps < *samples)) {
    report.divergence = {*steps, {}, "step", "digest", ""};
    report.error = fmt::format("diverged at step {}: step digest", *steps);
  } else if (samples) {  // all that the performer perceived was as before
    report.divergence = {*samples, {}, "performer", "samples", ""};
    report.error = fmt::format("the performer changed: its samples differ from step {} on, and no step before does {}",
                               *samples, wasAndIs("performer"));
  } else {
    report.verdict = recorder::ReplayVerdict::exact;
    report.finding = recorder::ReplayFinding::compared;
  }
}

GoldenReplay replayGolden(const std::filesystem::path& file, const GoldenEntry& entry, unsigned threads) {
  GoldenReplay replay;
  if (entry.isDigests()) {
    readJson(file);  // before the minutes of a run
    replay = perform(entry, {}, threads);
    judge(replay, file);
  } else {
    std::unique_ptr<analytics::CheckpointCollector> collector;
    recorder::ReplaySettings settings;
    settings.threads = threads;
    settings.observers = [&](const recorder::AttemptHeader& h, const SceneDescription& scene) {
      collector = std::make_unique<analytics::CheckpointCollector>(h, scene);
      return std::vector<recorder::Observer*>{collector.get()};
    };
    replay.report = recorder::replayRecording(file, settings);
    if (replay.report.verdict == recorder::ReplayVerdict::exact) replay.values = goldenValues(collector->values());
  }
  if (replay.report.verdict != recorder::ReplayVerdict::exact) return replay;
  replay.changed = changedValues(entry.values, replay.values);
  if (replay.changed.empty()) return replay;
  // The simulation is the same; what is computed over it is not.
  replay.report.verdict = recorder::ReplayVerdict::diverged;
  replay.report.finding = recorder::ReplayFinding::unread;
  replay.report.error =
      fmt::format("bit-exact, but {} checkpoints have other values: {}", replay.changed.size(), replay.changed.front());
  return replay;
}

/// A changed value needs a definition of a higher version, a value that is gone a checkpoint that is gone.
/// @throws Error (refused) naming the first value that changed without its definition.
void refuseValues(const GoldenEntry& entry, const std::vector<GoldenValue>& now) {
  for (const GoldenValue& before : entry.values) {
    const GoldenValue* after = sameOf(now, before);
    const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(before.name);
    if (after == nullptr && definition == nullptr) continue;
    const std::uint32_t version = after != nullptr ? after->version : definition->version;
    if (version > before.version || (after != nullptr && after->value == before.value)) continue;
    throw Error(ErrorKind::refused,
                fmt::format("golden: {}: {} has another value ({} -> {}) and still definition version "
                            "{}: raise the version or mend the checkpoint",
                            entry.file, titleOf(before), shownValue(before),
                            after == nullptr ? "none" : shownValue(*after), before.version));
  }
}

/// A golden names a revision.
/// @throws Error (invalid): `folder` is in no work tree, or in one with changes outside of it
void refuseChanges(const std::filesystem::path& folder) {
  std::string quoted, changes;
  for (const char c : folder.string()) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  const std::string command = "git -C '" + quoted + "' status --porcelain -- :/ ':(exclude).' 2>/dev/null";
  std::FILE* const pipe = popen(command.c_str(), "r");
  for (int c = 0; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) changes += static_cast<char>(c);
  const std::string fault = pipe == nullptr || pclose(pipe) != 0 ? " lies in no git work tree, or git is not there"
                            : changes.empty()                    ? ""
                                                                 : ": the work tree has changes (" +
                                                    changes.substr(0, changes.find('\n')) + "): commit them first";
  if (!fault.empty())
    throw Error(ErrorKind::invalid, "golden: " + folder.string() + fault + ": goldens belong to a revision");
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
  Progress progress("Replaying", o.json, "recordings");
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
  list.valuesReason = o.reason;
  Progress progress("Replaying", false, "recordings");
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
  recorder::writeText(folder / listName, recorder::writeRecord(list).dump(1) + "\n", true);
  return ExitCode::yes;
}

/// Makes every golden of the list again after a change of the simulation; within a simulation version those that are
/// not there, and digests whose performer or scene changed. Then replaces files and list together.
/// @throws Error with nothing replaced; (invalid) where nothing is to be made; (refused) where a step changed
void updateGolden(const GoldenOptions& o) {
  stopOnSignals();
  const std::filesystem::path folder = folderOf(o);
  GoldenList list = readGoldenList(folder / listName);
  if (list.simulationVersion > simulationVersion) {
    throw Error(ErrorKind::invalid, fmt::format("golden: the goldens are of simulation version {}, this build has {}: "
                                                "only a newer build makes them again",
                                                list.simulationVersion, simulationVersion));
  }
  refuseChanges(folder);
  const bool all = list.simulationVersion < simulationVersion;
  std::list<recorder::NewFile> fresh;
  for (GoldenEntry& entry : list.recordings) {
    const std::filesystem::path file = folder / entry.file;
    const bool kept = !all && std::filesystem::exists(file);
    if (kept && !entry.isDigests()) continue;  // no performer changes it: it carries its samples
    const std::filesystem::path& target = fresh.emplace_back(file, true).path();
    GoldenReplay made = perform(entry, entry.isDigests() ? std::filesystem::path() : target, 1);
    if (kept) {
      judge(made, file);
      if (made.report.verdict == recorder::ReplayVerdict::exact) {
        fresh.pop_back();
        continue;
      }
      if (made.report.divergence && made.report.divergence->component == "step") {
        throw Error(ErrorKind::refused, fmt::format("golden: {}: {}: what changes a step raises simulationVersion "
                                                    "(sim/scene/version.h) first",
                                                    entry.file, made.report.error));
      }
      fmt::print("{}: {}\n", entry.file, made.report.error);
    }
    if (entry.isDigests()) {
      made.digests["reason"] = o.reason;
      recorder::writeText(target, made.digests.dump(1) + "\n", true);
    }
    printChanges(entry.file, made.values.size(), changedValues(entry.values, made.values));
    entry.values = std::move(made.values);
  }
  if (fresh.empty()) {
    throw Error(ErrorKind::invalid,
                fmt::format("golden: the goldens are of simulation version {} and so is this build, and no performer "
                            "changed: what changes them raises simulationVersion (sim/scene/version.h) first",
                            list.simulationVersion));
  }
  for (recorder::NewFile& file : fresh) file.publish();
  if (all) {
    list.reason = o.reason;
    list.valuesReason.reset();
  }
  list.simulationVersion = simulationVersion;
  recorder::writeText(folder / listName, recorder::writeRecord(list).dump(1) + "\n", true);
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
  const auto stated = [](const std::string& reason) {
    return reason.find_first_not_of(" \t\n") == std::string::npos ? "say why goldens or their values change" : "";
  };
  for (CLI::App* one : {updating, values})
    one->add_option("--reason", o->reason, "why they change; kept with them")->required()->check(stated);
}

}  // namespace calot::apps

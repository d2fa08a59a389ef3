// SPDX-License-Identifier: GPL-3.0-or-later
// calot import: motion without a scene into a cohort.

#include <algorithm>
#include <map>
#include <set>

#include "analytics/assess.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/intake/manifests.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "gui/words/attempt_summary.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/sources/column_map.h"

namespace calot::apps {

CLI::Option* addMetrics(CLI::App& command, MetricOptions& options) {
  CLI::Option* metric =
      command
          .add_option("--metric", options.files,
                      "a Python script whose compute(attempt) gives a metric of your own; it runs with your rights")
          ->type_size(1)
          ->allow_extra_args(false);
  command.add_option("--metric-seconds", options.limits.seconds, "what a script may take for one attempt (s)")
      ->check(CLI::Range(1U, 86400U))
      ->needs(metric)
      ->capture_default_str();
  command.add_option("--metric-memory", options.limits.mebibytes, "memory of a script, beyond its input (MiB)")
      ->check(CLI::Range(256U, 1048576U))
      ->needs(metric)
      ->capture_default_str();
  return metric;
}

std::vector<analytics::MetricScript> readMetrics(const MetricOptions& options) {
  return analytics::readMetricScripts(options.files, options.limits,
                                      [](const std::string& script, const std::string& line) {
                                        Progress::erase();
                                        fmt::print(stderr, "{}: {}\n", script, line);
                                      });
}

void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const analytics::CohortDatabase& database) {
  for (const analytics::MetricScript& script : metrics) {
    try {
      database.checkMetric(*script.metric());
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::refused) throw;
      throw Error(e.kind(), Where{script.file()}, e.fault(), e.remedies());
    }
  }
}

void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const std::string& cohort) {
  if (metrics.empty() || !std::filesystem::exists(cohort)) return;
  checkMetrics(metrics, analytics::CohortDatabase(cohort, analytics::CohortDatabase::Access::write));
}

ExitCode reportFailures(const analytics::MetricOutcomes& outcomes, const std::string& attempt) {
  std::vector<ExitCode> codes{ExitCode::yes};
  for (const Error& e : outcomes.failures) {
    Progress::erase();
    fmt::print(stderr, "calot: {} (of {}; no value of it is stored)\n", messageOf(e), attempt);
    codes.push_back(codeOf(e.kind()));
  }
  return worstOf(codes);
}

Json failuresJson(const analytics::MetricOutcomes& outcomes) {
  Json list = Json::array();
  for (const Error& e : outcomes.failures) list.push_back(messageOf(e));
  return list;
}

recorder::TrackedMotion readMotion(const std::filesystem::path& file, const recorder::ColumnMap* map) {
  if (map != nullptr) return recorder::readCsvMotion(file, *map);
  if (recorder::isKinematicsFile(file)) return recorder::trackedMotion(recorder::readKinematics(file));
  recorder::ColumnMap recognised;
  try {
    recognised = recorder::recognisedMap(file);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::invalid) throw;
    throw Error(
        e.kind(), e.where(),
        e.fault() + ": calot import --guess writes a map of its columns; fill it in and name it with --columns");
  }
  return recorder::readCsvMotion(file, recognised);
}

ExitCode refuseRows(const std::vector<Error>& faults) {
  constexpr std::size_t most = 20;
  std::vector<ExitCode> codes;
  codes.reserve(faults.size());
  for (const Error& fault : faults) codes.push_back(codeOf(fault.kind()));
  for (std::size_t i = 0; i < std::min(faults.size(), most); ++i)
    fmt::print(stderr, "calot: {}\n", messageOf(faults[i]));
  if (faults.size() > most)
    fmt::print(stderr, "calot: and {} more wrong rows; nothing was stored\n", faults.size() - most);
  return worstOf(codes);
}

namespace {

struct ImportOptions {
  std::vector<std::string> files;
  std::string manifest, cohort, columns, mode = "practice", outcome = "stopped";
  analytics::MotionDeclaration declaration;
  analytics::TableReading reading;
  MetricOptions metrics;
  double cutoff = 0.0;
  bool json = false, guess = false;
};

/// Result for one file.
struct ImportedFile {
  ExitCode code = ExitCode::yes;
  std::string how = "not stored", error;
  std::optional<recorder::TrackedMotion> motion;
  std::vector<analytics::CheckpointValue> values;
  analytics::MetricOutcomes external;
};

/// A row of the output with --json.
Json fileJson(const std::string& file, const ImportedFile& result) {
  Json row = {{"file", file}, {"stored", result.how}};
  if (!result.error.empty()) row["error"] = result.error;
  if (result.motion) {
    row["sha256"] = result.motion->sha256;
    row["rows"] = result.motion->time.size();
    row["seconds"] = result.motion->time.back();
  }
  if (result.motion && !result.motion->notes.empty()) row["notes"] = result.motion->notes;
  row["checkpoints"] = jsonOf(result.values);
  if (!result.external.failures.empty()) row["failed_metrics"] = failuresJson(result.external);
  return row;
}

/// Shared by the files of a run.
struct Import {
  explicit Import(const ImportOptions& options) : o(options), metrics(readMetrics(o.metrics)) {
    checkMetrics(metrics, o.cohort);
  }

  /// Reads a file, computes its values, stores them where there is a cohort. A damaged file, or a conflict when it is
  /// stored, is the file's own result; what ends every file (a wrong command line, a database that cannot be used) is
  /// thrown. @param enrol called before the first value is stored
  ImportedFile take(const std::filesystem::path& file, const recorder::ColumnMap* map,
                    const analytics::MotionDeclaration& declaration, const std::function<void()>& enrol = {}) {
    ImportedFile result;
    try {
      result.motion = readMotion(file, map);
      result.external = analytics::externalOf(*result.motion, declaration, metrics);
      // Only now, so that files none of which can be read, and metrics that cannot be run, make no database.
      if (!o.cohort.empty() && !database) database.emplace(o.cohort, analytics::CohortDatabase::Access::create);
      if (enrol) enrol();
      compute(declaration, result);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::invalid || e.kind() == ErrorKind::failure ||
          (result.motion && e.kind() != ErrorKind::refused))
        throw;
      result.code = codeOf(e.kind());
      result.error = messageOf(e);
    }
    codes.push_back(worstOf({result.code, reportFailures(result.external, file.string())}));
    if (o.json) list.push_back(fileJson(file.string(), result));
    return result;
  }

  const ImportOptions& o;
  std::vector<analytics::MetricScript> metrics;
  std::optional<analytics::CohortDatabase> database;
  std::vector<ExitCode> codes;
  Json list = Json::array();

 private:
  void compute(const analytics::MotionDeclaration& declaration, ImportedFile& file) {
    if (database) {
      analytics::StoredMotion stored = analytics::storeMotion(*database, *file.motion, declaration);
      file.how = importedName(stored.imported);
      file.values = std::move(stored.values);
      if (analytics::storeExternal(*database, stored.attempt, file.external, metrics) &&
          stored.imported == analytics::Imported::unchanged)
        file.how = importedName(analytics::Imported::extended);
    } else {
      file.values = analytics::valuesFromSamples(*file.motion, {declaration.outcome, declaration.handedness, o.cutoff});
    }
    file.values.insert(file.values.end(), file.external.values.begin(), file.external.values.end());
  }
};

ExitCode importFiles(const ImportOptions& o) {
  checkStored(o.cohort, o.cutoff);
  std::optional<recorder::ColumnMap> map;
  if (!o.columns.empty()) map = recorder::readColumnMap(o.columns);
  Import import(o);
  Progress progress("Importing", o.json, "files");
  for (const std::string& file : o.files) {
    const ImportedFile result = import.take(file, map ? &*map : nullptr, o.declaration);
    progress.show(import.codes.size(), o.files.size());
    Progress::erase();
    if (!result.error.empty()) fmt::print(stderr, "calot: {}\n", result.error);
    if (!o.json && result.error.empty()) {
      fmt::print("{}: {}, {:.2f} s, {}\n", file, o.cohort.empty() ? "shown" : result.how, result.motion->time.back(),
                 recorder::counted(result.motion->time.size(), "row"));
      for (const std::string& note : result.motion->notes) fmt::print("  {}\n", note);
      if (o.files.size() == 1 || o.cohort.empty()) {
        gui::printValues(result.values, {}, std::cout);
        std::cout << '\n';
      }
    }
  }
  printResult(o.json, "import", {{"files", import.list}}, [&](std::ostream& out) {
    if (import.database) gui::printAttempts(*import.database, out);
  });
  return worstOf(import.codes);
}

/// "expert 6, novice 6", or empty without groups.
std::string groupsOf(const analytics::MotionManifest& manifest) {
  std::map<std::string, std::size_t> groups;
  for (const auto& entry : manifest.participants) ++groups[entry.second.group];
  if (groups.size() == 1 && groups.begin()->first.empty()) return {};
  std::string text;
  for (const auto& [group, people] : groups)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", group.empty() ? "without group" : group, people);
  return " (" + text + ")";
}

std::string summaryOf(const analytics::MotionManifest& manifest, const std::map<std::string, std::size_t>& counts,
                      std::size_t practice) {
  std::string how;
  for (const auto& [word, files] : counts) how += fmt::format("{}{} {}", how.empty() ? "" : ", ", files, word);
  std::string text =
      fmt::format("{}: {}: {}; {}{}\n", manifest.path, recorder::counted(manifest.rows.size(), "file"), how,
                  recorder::counted(manifest.participants.size(), "participant"), groupsOf(manifest));
  if (practice > 0)
    text += fmt::format(
        "{} in practice mode: studies leave these out (a column \"mode\", or --mode assessment, says otherwise)\n",
        practice);
  return text;
}

ExitCode importManifest(const ImportOptions& o) {
  std::vector<Error> faults;
  std::optional<analytics::Enrolment> enrolment;
  std::vector<analytics::Participant> enrolledBefore;
  if (std::filesystem::exists(o.cohort)) {
    const analytics::CohortDatabase cohort(o.cohort, analytics::CohortDatabase::Access::write);
    enrolment.emplace(cohort);
    enrolledBefore = cohort.participants();
  }
  const analytics::MotionManifest manifest =
      analytics::readMotionManifest(o.manifest, o.declaration, o.columns, o.reading, enrolledBefore, faults);
  if (enrolment) {
    const std::vector<Error> conflicts = enrolment->conflicts(manifest);
    faults.insert(faults.end(), conflicts.begin(), conflicts.end());
  }
  if (!faults.empty()) return refuseRows(faults);
  Import import(o);
  std::vector<std::string> errors;
  std::map<std::string, std::size_t> counts;
  std::set<std::string> enrolled;
  std::size_t practice = 0;
  {
    Progress progress("Importing", o.json, "files");
    for (const analytics::MotionRow& row : manifest.rows) {
      progress.show(import.codes.size(), manifest.rows.size());
      const auto map = manifest.maps.find(row.columns);
      const auto enrol = [&] {
        if (!enrolment) enrolment.emplace(*import.database);
        const std::string& who = row.declaration.participant;
        if (!who.empty() && enrolled.insert(who).second)
          enrolment->add(*import.database, manifest.participants.at(who));
      };
      const ImportedFile result =
          import.take(row.file, map == manifest.maps.end() ? nullptr : &map->second, row.declaration, enrol);
      ++counts[result.how];
      if (result.error.empty() && row.declaration.mode == recorder::Mode::practice) ++practice;
      if (!result.error.empty())
        errors.push_back(fmt::format("{}: line {}: {}", manifest.path, row.line, result.error));
    }
  }
  printResult(o.json, "import", {{"files", import.list}}, summaryOf(manifest, counts, practice));
  for (const std::string& error : errors) fmt::print(stderr, "calot: {}\n", error);
  return worstOf(import.codes);
}

/// For CLI::Option::check.
std::function<std::string(const std::string&)> wordOf(const char* field) {
  return [field](const std::string& word) {
    analytics::MotionDeclaration ignored;
    return analytics::declareMotion(ignored, field, word);
  };
}

ExitCode importMotion(ImportOptions& o) {
  analytics::declareMotion(o.declaration, "mode", o.mode);
  analytics::declareMotion(o.declaration, "outcome", o.outcome);
  if (o.files.empty() && o.manifest.empty())
    throw Error(ErrorKind::invalid, "import: name motion files, or a table of them with --manifest");
  if (o.guess) {
    if (o.files.size() != 1) throw Error(ErrorKind::invalid, "import: --guess is for one file");
    if (recorder::isKinematicsFile(o.files.front())) {
      recorder::readKinematics(o.files.front());  // or its fault
      throw Error(ErrorKind::invalid, Where{o.files.front()},
                  "motion in 76 numbers a row without names (JIGSAWS) is recognised and has no map: leave --guess out");
    }
    fmt::print("{}\n", recorder::guessColumns(o.files.front()).json);
    return ExitCode::yes;
  }
  if (o.manifest.empty()) return importFiles(o);
  if (o.cohort.empty() || o.cutoff > 0.0)
    throw Error(ErrorKind::invalid, "import: --manifest stores what it names: give --cohort, and no --cutoff");
  return importManifest(o);
}

}  // namespace

void addImport(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"import", "Computes the motion checkpoints of motion without a scene and stores them in a cohort.",
                  "calot import knots.txt --task knot-tying --participant P1 --mode assessment --cohort c.db",
                  "calot import --manifest table.csv --mode assessment --cohort c.db"},
                 importMotion);
  CLI::Option* manifest = command->add_option(
      "--manifest", o->manifest,
      "A CSV table instead of files: a row each with file, participant, group, task, start, outcome, experience and "
      "what the options below say; these stand for what it leaves out");
  command
      ->add_option(
          "files", o->files,
          "two-handed motion, 76 columns at 30 Hz; CSV files of Motive, Vicon, NDI or ROS; others with --columns")
      ->excludes(manifest);
  addSimilarNames(*command, o->reading.names)->needs(manifest);
  command
      ->add_option_function<std::string>(
          "--dates",
          [&dates = o->reading.dates](const std::string& word) {
            using Order = recorder::DateStyle::Order;
            dates.order = word == "day-first" ? Order::dayFirst : Order::monthFirst;
          },
          "What comes first in dates of the table such as 3/4/2026: day-first or month-first")
      ->check(oneOf({"day-first", "month-first"}))
      ->needs(manifest);
  command
      ->add_option_function<std::string>(
          "--zone", [&dates = o->reading.dates](const std::string& word) { dates.zone = recorder::readZone(word); },
          "The zone of times of the table that name none: Z (universal time) or +01:00")
      ->check([](const std::string& word) {
        return recorder::readZone(word) ? std::string() : "Z or an offset such as +01:00 is expected";
      })
      ->needs(manifest);
  addStoring(*command, o->cohort, o->cutoff);
  addMetrics(*command, o->metrics);
  command->add_option("--columns", o->columns, "a JSON file that says what the columns of the CSV files are");
  command
      ->add_flag("--guess", o->guess,
                 "prints a map of the columns of one file, as far as the file says; stores nothing")
      ->excludes(manifest);
  command->add_option("--task", o->declaration.task, "what was done; attempts of different tasks are never compared")
      ->check(wordOf("task"))
      ->capture_default_str();
  command->add_option("--participant", o->declaration.participant, "pseudonym")
      ->transform(CLI::Validator(pseudonymForm, ""));
  addChoice(*command, "--mode", o->mode, "practice or assessment", {"practice", "assessment"});
  command
      ->add_option("--purpose", o->declaration.purpose,
                   "training, study, demo (default: study with a consent to study or research, else training)")
      ->check(wordOf("purpose"));
  addChoice(*command, "--handedness", o->declaration.handedness, "right, left, unknown", {"right", "left", "unknown"});
  addChoice(*command, "--outcome", o->outcome, "completed, abandoned, stopped", {"completed", "abandoned", "stopped"});
  command->add_option("--start", o->declaration.startUtc, "when it began: 2026-01-31T12:00:00Z")
      ->check(wordOf("start"));
  command->add_flag("--json", o->json, "print the result as JSON");
}

}  // namespace calot::apps

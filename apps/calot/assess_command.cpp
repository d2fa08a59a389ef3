// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <functional>

#include "analytics/assess.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort_files.h"
#include "analytics/regrade.h"
#include "analytics/uncertainty/uncertainty.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "gui/words/attempt_summary.h"
#include "recorder/base/counted.h"
#include "recorder/recording/probe.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

namespace fs = std::filesystem;

struct AssessOptions {
  std::vector<std::string> files;
  std::string cohort;
  std::optional<unsigned> threads;
  bool uncertainty = false;
  double cutoff = 0.0;  ///< 0: values are stored
  MetricOptions metrics;
  std::optional<std::string> share;
  unsigned jobs = 1;
  bool apart = false, json = false;
};

/// Files as they are named, those of folders by name; of a share, its own.
std::vector<std::string> filesOf(const AssessOptions& o) {
  std::error_code ignored;
  const auto isFolder = [&](const std::string& place) { return std::filesystem::is_directory(place, ignored); };
  std::vector<std::filesystem::path> files(o.files.begin(), o.files.end());
  if (std::any_of(o.files.begin(), o.files.end(), isFolder)) files = analytics::recordingsUnder(files);
  if (o.share) files = analytics::filesOf(analytics::shareNamed(*o.share), files);
  return {files.begin(), files.end()};
}

/// Result for one file, besides the replay's report.
struct Stored {
  std::string keyFault;
  std::string how = "not stored";
  std::vector<analytics::CheckpointValue> values;
  std::vector<analytics::ValueInterval> intervals;
  analytics::MetricOutcomes external;
};

/// The intervals that the cohort has of these values, or else new ones.
std::vector<analytics::ValueInterval> intervalsOf(const std::string& file, const AssessOptions& o,
                                                  const std::string& attempt,
                                                  const std::vector<analytics::CheckpointValue>& values,
                                                  analytics::CohortDatabase& database) {
  const auto there = [](const analytics::CheckpointValue& v) { return v.value.has_value(); };
  const auto count = std::count_if(values.begin(), values.end(), there);
  std::vector<analytics::ValueInterval> known = database.intervals(attempt);
  if (count == static_cast<std::ptrdiff_t>(known.size())) return known;
  Progress progress("Uncertainty of " + fs::path(file).filename().string(), o.json, "runs");
  std::vector<analytics::ValueInterval> made = analytics::estimateUncertainty(
      file, values, o.threads.value_or(0), [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  database.storeIntervals(attempt, made);
  return made;
}

/// Stores what judging one recording gave. A damaged file is no attempt of the cohort. A conflict with what the cohort
/// holds is this file's answer: it takes the place of the report.
void storeJudged(const std::string& file, const AssessOptions& o,
                 const std::function<analytics::CohortDatabase&()>& cohort,
                 const std::vector<analytics::MetricScript>& metrics, analytics::JudgedRecording& judged,
                 Stored& stored) {
  if (!judged.record) return;
  analytics::CohortDatabase& database = cohort();
  try {
    stored.how = importedName(database.storeAttempt(*judged.record, judged.values));
    stored.keyFault = keyFaultOf(*judged.record, o.cohort);
    if (o.uncertainty && judged.report.verdict == recorder::ReplayVerdict::exact)
      stored.intervals = intervalsOf(file, o, judged.record->uuid, judged.values, database);
    stored.values = std::move(judged.values);
    const bool isNew = analytics::storeExternal(database, judged.record->uuid, judged.external, metrics);
    if (isNew && stored.how == importedName(analytics::Imported::unchanged))
      stored.how = importedName(analytics::Imported::extended);
    stored.external = std::move(judged.external);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::refused) throw;
    judged.report = {};
    judged.report.path = file;
    judged.report.verdict = recorder::ReplayVerdict::diverged;
    judged.report.error = recorder::messageWithout(file, e);
    judged.report.remedies = e.remedies();
  }
}

nlohmann::json assessedJson(const recorder::ReplayReport& report, const Stored& stored) {
  nlohmann::json row = reportJson(report);
  row["stored"] = stored.how;
  if (!stored.keyFault.empty()) row["key"] = stored.keyFault;
  row["checkpoints"] = jsonOf(stored.values, stored.intervals);
  if (!stored.external.failures.empty()) row["failed_metrics"] = failuresJson(stored.external);
  return row;
}

void printAssessed(const recorder::ReplayReport& report, const Stored& stored, bool everyValue) {
  printReport(report);
  if (!stored.keyFault.empty()) fmt::print(stderr, "calot: warning: {}: {}\n", report.path.string(), stored.keyFault);
  if (!everyValue) return;
  std::fflush(stdout);
  gui::printValues(stored.values, stored.intervals, std::cout);
  std::cout << '\n' << std::flush;
}

/// Leaves out what a run of this share that was cut short has stored already.
void removeVerified(std::vector<std::string>& files, const analytics::CohortDatabase& database) {
  const std::size_t count = files.size();
  std::erase_if(files, [&](const std::string& file) {
    try {
      return analytics::isVerified(database, recorder::identify(file));
    } catch (const Error&) {
      return false;  // assessing it reports why
    }
  });
  if (files.size() < count) {
    Progress::erase();
    fmt::print(stderr, "calot: {} of {} recordings were verified by an earlier run\n", count - files.size(), count);
  }
}

ExitCode assess(const AssessOptions& o) {
  checkStored(o.cohort, o.cutoff);
  std::vector<std::string> files = filesOf(o);
  const bool everyValue = files.size() == 1 || o.cohort.empty();
  Progress progress("Assessing " + (files.size() == 1 ? fs::path(files.front()).filename().string()
                                                      : recorder::counted(files.size(), "recording")),
                    o.json);
  std::optional<recorder::ProbeProcesses> probes;
  if (files.size() > 1) probes.emplace(o.jobs);
  std::optional<analytics::CohortDatabase> database;
  const std::vector<analytics::MetricScript> metrics = readMetrics(o.metrics);
  // One that is not there is made for the first recording that can be stored.
  const auto cohort = [&]() -> analytics::CohortDatabase& {
    if (!database) database.emplace(o.cohort, analytics::CohortDatabase::Access::create);
    return *database;
  };
  if (!o.cohort.empty() && std::filesystem::exists(o.cohort)) checkMetrics(metrics, cohort());
  if (o.share && database) removeVerified(files, *database);
  std::vector<ExitCode> codes;
  nlohmann::json list = nlohmann::json::array();
  analytics::AssessSettings settings{.threads = o.threads.value_or(1),
                                     .engine = {.apart = o.apart},
                                     .metrics = &metrics,
                                     .progress = [&](std::uint64_t done, std::uint64_t of) {
                                       progress.showShare(static_cast<double>(done) / static_cast<double>(of));
                                     }};
  if (o.cutoff > 0.0) settings.cutoff = o.cutoff;
  recorder::WorkerPool pool(o.jobs);
  analytics::judgeAll(files, pool, settings, [&](std::size_t i, analytics::JudgedRecording judged) {
    Stored stored;
    if (!o.cohort.empty()) {
      storeJudged(files[i], o, cohort, metrics, judged, stored);
    } else {
      stored.values = std::move(judged.values);
      stored.external = std::move(judged.external);
    }
    for (const analytics::CheckpointValue& v : stored.external.values) stored.values.push_back(v);
    codes.push_back(codeOf(judged.report.fault()));
    codes.push_back(reportFailures(stored.external, judged.report.path.string()));
    if (o.json) {
      list.push_back(assessedJson(judged.report, stored));
    } else {
      printAssessed(judged.report, stored, everyValue);
    }
  });
  printResult(o.json, "assess", {{"recordings", list}}, [&](std::ostream& out) {
    if (database) gui::printAttempts(*database, out);
  });
  return worstOf(codes);
}

}  // namespace

void addAssess(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"assess", "Re-simulates recordings, computes their checkpoints and stores them in a cohort.",
                  "calot assess attempt.h5 --cohort c.db", "calot assess recordings --cohort c.db --metric my.py"},
                 assess);
  command->add_option("recordings", o->files, "recordings, or folders that hold them")->required();
  addStoring(*command, o->cohort, o->cutoff);
  addMetrics(*command, o->metrics);
  command
      ->add_option("--share", o->share,
                   "assess one share alone: 3/8 is the third of eight; recordings that the cohort holds verified are "
                   "left out, so that a run that was cut short goes on")
      ->needs("--cohort");
  addThreads(*command, o->jobs, "recordings at a time; 0: one a processor", "--jobs");
  command
      ->add_flag("--uncertainty", o->uncertainty,
                 "stores an interval with each value: runs the attempt again in smaller steps, with a finer mesh and "
                 "with other assumed constants (takes some fifteen replays)")
      ->needs("--cohort");
  command
      ->add_option("--threads", o->threads,
                   "segments between keyframes that are verified at a time (1), or with --uncertainty runs at a time "
                   "(0); 0: one a processor")
      ->check(CLI::Range(0U, 64U));
  command->add_flag("--apart", o->apart,
                    "re-simulate in confined programs, as recordings of other simulation versions are");
  command->add_flag("--json", o->json, "print the result as JSON");
}

}  // namespace calot::apps

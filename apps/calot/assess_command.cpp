// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "analytics/assess.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/from_observables.h"
#include "analytics/checkpoints/motion.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/value_report.h"
#include "recorder/attempt.h"
#include "recorder/errors.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

struct Options {
  std::vector<std::string> files;
  std::string cohort;
  unsigned threads = 1;
  double cutoff = 0.0;  ///< 0: values are stored
  bool json = false;
};

analytics::Verdict verdictOf(recorder::ReplayVerdict verdict) {
  switch (verdict) {
    case recorder::ReplayVerdict::exact:
      return analytics::Verdict::verified;
    case recorder::ReplayVerdict::diverged:
      return analytics::Verdict::diverged;
    case recorder::ReplayVerdict::damaged:
      return analytics::Verdict::damaged;
    case recorder::ReplayVerdict::undecided:
      return analytics::Verdict::notCheckableHere;
  }
  return analytics::Verdict::notChecked;
}

/// What one file gave, beside the replay's report.
struct Stored {
  std::string how = "not stored";
  std::vector<analytics::CheckpointValue> values;
};

/// Replays one recording with the checkpoints watching and stores the result, where there is a database. A damaged file
/// is no attempt of the cohort; a diverged one is, without values; one of another simulation version with those of its
/// observables.
recorder::ReplayReport assessOne(const std::string& file, const Options& o, analytics::CohortDatabase* database,
                                 Stored& stored) {
  const double cutoff = o.cutoff > 0.0 ? o.cutoff : analytics::motionCutoff;
  recorder::AttemptHeader header;
  std::unique_ptr<analytics::CheckpointCollector> collector;
  recorder::ReplaySettings settings;
  settings.threads = o.threads;
  settings.observers = [&](const recorder::AttemptHeader& h, const Model& model) {
    header = h;
    collector =
        std::make_unique<analytics::CheckpointCollector>(h, model.scene(), analytics::Origin::resimulated, cutoff);
    return std::vector<recorder::Observer*>{collector.get()};
  };
  recorder::ReplayReport report = recorder::replayRecording(file, settings);
  if (report.verdict == recorder::ReplayVerdict::damaged) return report;
  if (header.attempt.empty()) header = recorder::Recording(file).header();
  analytics::AssessedAttempt assessed;
  assessed.header = std::move(header);
  assessed.outcome = report.outcome;
  assessed.complete = report.complete;
  assessed.steps = report.steps;
  assessed.chainHead = report.chainHead;
  assessed.verification = {verdictOf(report.verdict),
                           report.verdict == recorder::ReplayVerdict::exact ? "" : report.message,
                           recorder::softwareName()};
  if (report.verdict == recorder::ReplayVerdict::exact) assessed.values = collector->values();
  if (report.verdict == recorder::ReplayVerdict::undecided && report.chainIntact) {
    recorder::Recording recording(file);
    assessed.values = analytics::valuesFromObservables(recording, cutoff);
  }
  assessed.fileName = std::filesystem::path(file).filename().string();
  if (database != nullptr) stored.how = importedName(analytics::store(*database, assessed));
  stored.values = std::move(assessed.values);
  return report;
}

int assess(const Options& o) {
  checkStored(o.cohort, o.cutoff);
  std::optional<analytics::CohortDatabase> database;
  if (!o.cohort.empty()) database.emplace(o.cohort, analytics::CohortDatabase::Access::create);
  std::vector<recorder::ReplayReport> reports;
  nlohmann::json list = nlohmann::json::array();
  Progress progress("assessing, recordings", o.json);
  for (const std::string& file : o.files) {
    Stored stored;
    try {
      reports.push_back(assessOne(file, o, database ? &*database : nullptr, stored));
    } catch (const Error& e) {
      if (e.code() != ExitCode::no) throw;
      // A conflict with what the cohort holds is this file's answer; the others are still assessed.
      recorder::ReplayReport report;
      report.path = file;
      report.verdict = recorder::ReplayVerdict::diverged;
      report.message = e.what();
      reports.push_back(report);
    }
    progress.show(reports.size(), o.files.size());
    if (o.json) {
      nlohmann::json row = reportJson(reports.back());
      row["stored"] = stored.how;
      row["checkpoints"] = jsonOf(stored.values);
      list.push_back(row);
    } else {
      printReport(reports.back());
      if (o.files.size() == 1 || !database) {
        std::fflush(stdout);
        analytics::printValues(stored.values, std::cout);
        std::cout << '\n' << std::flush;
      }
    }
  }
  if (o.json) {
    std::cout << list.dump(2) << '\n';
  } else {
    std::cout << std::flush;
    std::fflush(stdout);
    if (database) analytics::printAttempts(*database, std::cout);
  }
  return static_cast<int>(worstOf(reports));
}

}  // namespace

void addAssess(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("assess", "Re-simulates recordings, computes their checkpoints and stores them in a cohort.");
  command->add_option("recordings", o->files, "recordings")->required();
  addStoring(*command, o->cohort, o->cutoff);
  command->add_option("--threads", o->threads, "of the simulation; 0: all")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] { run = [o] { return assess(*o); }; });
}

}  // namespace calot::apps

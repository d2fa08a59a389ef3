// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "analytics/assess.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/from_observables.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/replay_report.h"
#include "recorder/attempt.h"
#include "recorder/errors.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

struct Options {
  std::vector<std::string> files;
  std::string cohort;
  unsigned threads = 1;
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

const char* importedName(analytics::Imported imported) {
  switch (imported) {
    case analytics::Imported::added:
      return "added";
    case analytics::Imported::unchanged:
      return "unchanged";
    case analytics::Imported::extended:
      return "extended";
  }
  return "";
}

/// What one file gave, beside the replay's report.
struct Stored {
  std::string how = "not stored";
  std::vector<analytics::CheckpointValue> values;
};

/// Replays one recording with the checkpoints watching and stores the result. A damaged file is no attempt of the
/// cohort; a diverged one is, without values; one of another simulation version with those of its observables.
recorder::ReplayReport assessOne(const std::string& file, const Options& o, analytics::CohortDatabase& database,
                                 Stored& stored) {
  recorder::AttemptHeader header;
  std::unique_ptr<analytics::CheckpointCollector> collector;
  recorder::ReplaySettings settings;
  settings.threads = o.threads;
  settings.observers = [&](const recorder::AttemptHeader& h, const Model& model) {
    header = h;
    collector = std::make_unique<analytics::CheckpointCollector>(h, model.scene());
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
    assessed.values = analytics::valuesFromObservables(recording);
  }
  assessed.fileName = std::filesystem::path(file).filename().string();
  stored.how = importedName(analytics::store(database, assessed));
  stored.values = std::move(assessed.values);
  return report;
}

nlohmann::ordered_json jsonOf(const std::vector<analytics::CheckpointValue>& values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const analytics::CheckpointValue& v : values) {
    nlohmann::ordered_json row = {{"name", v.name}, {"subject", v.subject}, {"version", v.version}};
    row["value"] = v.value ? nlohmann::ordered_json(*v.value) : nlohmann::ordered_json();
    row["unit"] = v.unit;
    row["origin"] = nameOf(v.origin);
    if (!v.value) {
      row["missing"] = v.availability == analytics::Availability::notApplicable ? "not applicable" : "not available";
      row["reason"] = v.reason;
    }
    if (!v.note.empty()) row["note"] = v.note;
    list.push_back(row);
  }
  return list;
}

int assess(const Options& o) {
  analytics::CohortDatabase database(o.cohort, analytics::CohortDatabase::Access::create);
  std::vector<recorder::ReplayReport> reports;
  nlohmann::json list = nlohmann::json::array();
  Progress progress("assessing, recordings", o.json);
  for (const std::string& file : o.files) {
    Stored stored;
    try {
      reports.push_back(assessOne(file, o, database, stored));
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
      if (o.files.size() == 1) {
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
    analytics::printAttempts(database, std::cout);
  }
  return static_cast<int>(worstOf(reports));
}

}  // namespace

void addAssess(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("assess", "Re-simulates recordings, computes their checkpoints and stores them in a cohort.");
  command->add_option("recordings", o->files, "recordings")->required();
  command->add_option("--cohort", o->cohort, "cohort database; made where there is none")->required();
  command->add_option("--threads", o->threads, "of the simulation; 0: all")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] { run = [o] { return assess(*o); }; });
}

}  // namespace calot::apps

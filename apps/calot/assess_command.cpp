// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "analytics/assess.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort/registers.h"
#include "analytics/uncertainty/uncertainty.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/value_report.h"
#include "recorder/errors.h"
#include "recorder/replay.h"

namespace calot::apps {

namespace {

struct AssessOptions {
  std::vector<std::string> files;
  std::string cohort;
  std::optional<unsigned> threads;
  bool uncertainty = false;
  double cutoff = 0.0;  ///< 0: values are stored
  bool json = false;
};

/// What one file gave, beside the replay's report.
struct Stored {
  std::string keyFault;
  std::string how = "not stored";
  std::vector<analytics::CheckpointValue> values;
  std::vector<analytics::ValueInterval> intervals;
};

/// The intervals that the cohort has of these values, or else new ones.
std::vector<analytics::ValueInterval> intervalsOf(const std::string& file, const AssessOptions& o,
                                                  const analytics::AssessedAttempt& attempt,
                                                  analytics::CohortDatabase& database) {
  const auto there = [](const analytics::CheckpointValue& v) { return v.value.has_value(); };
  const auto values = std::count_if(attempt.values.begin(), attempt.values.end(), there);
  std::vector<analytics::ValueInterval> known = database.intervals(attempt.header.attempt);
  if (values == static_cast<std::ptrdiff_t>(known.size())) return known;
  Progress progress(fmt::format("uncertainty of {}, runs", std::filesystem::path(file).filename().string()), o.json);
  std::vector<analytics::ValueInterval> made =
      analytics::estimateUncertainty(file, attempt.values, o.threads.value_or(0),
                                     [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  database.storeIntervals(attempt.header.attempt, made);
  return made;
}

/// Where a station's key is registered, its recordings are signed by it; empty: nothing to say.
std::string keyFaultOf(const analytics::AssessedAttempt& attempt, const std::string& cohort) {
  const std::string& station = attempt.header.station;
  if (station.empty()) return {};
  std::optional<analytics::PublicKey> key;
  if (attempt.signature) key = attempt.signature->publicKey;
  switch (analytics::standingOf(analytics::readRegisters(cohort), station, key)) {
    case analytics::KeyStanding::another:
      return fmt::format("signed by another key than that of station {} in {}", station, cohort);
    case analytics::KeyStanding::unsignedButExpected:
      return fmt::format("not signed, though station {} has a key in {}", station, cohort);
    default:
      return {};
  }
}

/// Assesses one recording and stores the result, where there is a database. A damaged file is no attempt of the cohort.
recorder::ReplayReport assessOne(const std::string& file, const AssessOptions& o, analytics::CohortDatabase* database,
                                 Stored& stored) {
  analytics::Assessment assessment =
      analytics::assessRecording(file, o.threads.value_or(1), o.cutoff > 0.0 ? o.cutoff : analytics::motionCutoff);
  if (!assessment.attempt) return assessment.report;
  if (database != nullptr) {
    stored.how = importedName(analytics::store(*database, *assessment.attempt));
    stored.keyFault = keyFaultOf(*assessment.attempt, o.cohort);
    if (o.uncertainty && assessment.report.verdict == recorder::ReplayVerdict::exact)
      stored.intervals = intervalsOf(file, o, *assessment.attempt, *database);
  }
  stored.values = std::move(assessment.attempt->values);
  return assessment.report;
}

int assess(const AssessOptions& o) {
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
      if (e.kind() != ErrorKind::refused) throw;
      // A conflict with what the cohort holds is this file's answer; the others are still assessed.
      recorder::ReplayReport report;
      report.path = file;
      report.verdict = recorder::ReplayVerdict::diverged;
      report.message = recorder::messageWithout(file, e);
      report.remedies = e.remedies();
      reports.push_back(report);
    }
    progress.show(reports.size(), o.files.size());
    if (o.json) {
      nlohmann::json row = reportJson(reports.back());
      row["stored"] = stored.how;
      if (!stored.keyFault.empty()) row["key"] = stored.keyFault;
      row["checkpoints"] = jsonOf(stored.values, stored.intervals);
      list.push_back(row);
    } else {
      printReport(reports.back());
      if (!stored.keyFault.empty()) fmt::print(stderr, "calot: warning: {}: {}\n", file, stored.keyFault);
      if (o.files.size() == 1 || !database) {
        std::fflush(stdout);
        analytics::printValues(stored.values, stored.intervals, std::cout);
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
  auto o = std::make_shared<AssessOptions>();
  CLI::App* command =
      app.add_subcommand("assess", "Re-simulates recordings, computes their checkpoints and stores them in a cohort.");
  command->add_option("recordings", o->files, "recordings")->required();
  addStoring(*command, o->cohort, o->cutoff);
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
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] { run = [o] { return assess(*o); }; });
}

}  // namespace calot::apps

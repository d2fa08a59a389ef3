// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "analytics/assess.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort/registers.h"
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
  unsigned threads = 1;
  double cutoff = 0.0;  ///< 0: values are stored
  bool json = false;
};

/// What one file gave, beside the replay's report.
struct Stored {
  std::string keyFault;
  std::string how = "not stored";
  std::vector<analytics::CheckpointValue> values;
};

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
      analytics::assessRecording(file, o.threads, o.cutoff > 0.0 ? o.cutoff : analytics::motionCutoff);
  if (!assessment.attempt) return assessment.report;
  if (database != nullptr) {
    stored.how = importedName(analytics::store(*database, *assessment.attempt));
    stored.keyFault = keyFaultOf(*assessment.attempt, o.cohort);
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
      row["checkpoints"] = jsonOf(stored.values);
      list.push_back(row);
    } else {
      printReport(reports.back());
      if (!stored.keyFault.empty()) fmt::print(stderr, "calot: warning: {}: {}\n", file, stored.keyFault);
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
  auto o = std::make_shared<AssessOptions>();
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

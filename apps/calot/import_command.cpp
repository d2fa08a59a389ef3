// SPDX-License-Identifier: GPL-3.0-or-later
// calot import: motion without a scene into a cohort.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "analytics/assess.h"
#include "analytics/checkpoints/from_samples.h"
#include "analytics/import_motion.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/metric_options.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/value_report.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/errors.h"
#include "recorder/sources/column_map.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/kinematics_file.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::apps {

namespace {

struct ImportOptions {
  std::vector<std::string> files;
  std::string cohort, columns, mode = "practice", outcome = "stopped";
  analytics::MotionDeclaration declaration;
  MetricOptions metrics;
  double cutoff = 0.0;
  bool json = false;
};

/// What came of one file.
struct Result {
  ExitCode code = ExitCode::yes;
  std::string how = "not stored", error;
  std::optional<recorder::TrackedMotion> motion;
  std::vector<analytics::CheckpointValue> values;
  analytics::MetricOutcomes external;

  void addExternal() { values.insert(values.end(), external.values.begin(), external.values.end()); }
};

recorder::TrackedMotion read(const std::string& file, const std::optional<recorder::ColumnMap>& map) {
  if (map) return recorder::readCsvMotion(file, *map);
  if (std::filesystem::path(file).extension() == ".csv")
    throw Error(ErrorKind::invalid, Where{file}, "a CSV file needs --columns MAP.json, which says what is in it");
  return recorder::trackedMotion(recorder::readKinematics(file));
}

/// Reads first, so that a file that cannot be read makes no database.
Result importOne(const std::string& file, const ImportOptions& o, const std::optional<recorder::ColumnMap>& map,
                 const std::vector<analytics::MetricScript>& metrics,
                 std::optional<analytics::CohortDatabase>& database) {
  Result result;
  try {
    result.motion = read(file, map);
    result.external = analytics::externalOf(*result.motion, o.declaration, metrics);
    if (o.cohort.empty()) {
      result.values =
          analytics::valuesFromSamples(*result.motion, {o.declaration.outcome, o.declaration.handedness, o.cutoff});
      result.addExternal();
      return result;
    }
    if (!database) {
      database.emplace(o.cohort, analytics::CohortDatabase::Access::create);
      checkMetrics(metrics, *database);
    }
    analytics::StoredMotion stored = analytics::storeMotion(*database, *result.motion, o.declaration);
    result.how = importedName(stored.imported);
    result.values = std::move(stored.values);
    const std::string attempt = analytics::recordOf(*result.motion, o.declaration).uuid;
    if (analytics::storeExternal(*database, attempt, result.external, metrics) &&
        stored.imported == analytics::Imported::unchanged)
      result.how = importedName(analytics::Imported::extended);
    result.addExternal();
  } catch (const Error& e) {
    // A wrong command line and a database that cannot be used end it all; a bad file is its own answer.
    if (e.kind() == ErrorKind::invalid || e.kind() == ErrorKind::failure ||
        (result.motion && e.kind() != ErrorKind::refused))
      throw;
    result.code = codeOf(e.kind());
    result.error = messageOf(e);
  }
  return result;
}

std::string summaryOf(const recorder::TrackedMotion& motion) {
  return fmt::format("{:.2f} s, {} rows", motion.time.back(), motion.time.size());
}

nlohmann::ordered_json jsonOf(const std::string& file, const Result& result) {
  nlohmann::ordered_json row = {{"file", file}, {"stored", result.how}};
  if (!result.error.empty()) row["error"] = result.error;
  if (result.motion) {
    row["sha256"] = result.motion->sha256;
    row["rows"] = result.motion->time.size();
    row["seconds"] = result.motion->time.back();
  }
  row["checkpoints"] = apps::jsonOf(result.values);
  if (!result.external.failures.empty()) row["failed_metrics"] = failuresJson(result.external);
  return row;
}

int import(const ImportOptions& o) {
  checkStored(o.cohort, o.cutoff);
  std::optional<recorder::ColumnMap> map;
  if (!o.columns.empty()) map = recorder::readColumnMap(o.columns);
  const std::vector<analytics::MetricScript> metrics = readMetrics(o.metrics);
  std::optional<analytics::CohortDatabase> database;
  std::vector<ExitCode> codes;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  Progress progress("importing, files", o.json);
  for (const std::string& file : o.files) {
    const Result result = importOne(file, o, map, metrics, database);
    codes.push_back(worstOf({result.code, reportFailures(result.external, file)}));
    progress.show(codes.size(), o.files.size());
    if (!result.error.empty()) fmt::print(stderr, "calot: {}\n", result.error);
    if (o.json) {
      list.push_back(jsonOf(file, result));
    } else if (result.error.empty()) {
      std::cout << fmt::format("{}: {}, {}\n", file, o.cohort.empty() ? "shown" : result.how,
                               summaryOf(*result.motion));
      if (o.files.size() == 1 || o.cohort.empty()) {
        analytics::printValues(result.values, {}, std::cout);
        std::cout << '\n';
      }
    }
  }
  if (o.json) {
    std::cout << list.dump(2) << '\n';
  } else if (database) {
    analytics::printAttempts(*database, std::cout);
  }
  return static_cast<int>(worstOf(codes));
}

std::string isWord(const std::string& text) {
  if (text.empty() || text.size() > 60) return "1 to 60 characters are wanted";
  for (const char c : text) {
    if (c <= ' ' || c > '~') return "a word without blanks is wanted";
  }
  return {};
}

}  // namespace

void addImport(CLI::App& app, Run& run) {
  auto o = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand(
      "import", "Computes the motion checkpoints of motion without a scene and stores them in a cohort.");
  command->add_option("files", o->files, "two-handed motion, 76 columns at 30 Hz; or CSV files with --columns")
      ->required();
  addStoring(*command, o->cohort, o->cutoff);
  addMetrics(*command, o->metrics);
  command->add_option("--columns", o->columns, "what the columns of the CSV files are (schemas/columns.schema.json)");
  command->add_option("--task", o->declaration.task, "what was done; attempts of different tasks are never compared")
      ->check(isWord)
      ->capture_default_str();
  command->add_option("--participant", o->declaration.participant, "pseudonym")->check([](const std::string& p) {
    return p.size() > 64 ? std::string("longer than 64 characters") : std::string();
  });
  command->add_option("--mode", o->mode, "practice or assessment")
      ->check(CLI::IsMember({"practice", "assessment"}))
      ->capture_default_str();
  command->add_option("--purpose", o->declaration.purpose, "training, study, demo")
      ->check(CLI::IsMember({"training", "study", "demo"}))
      ->capture_default_str();
  command->add_option("--handedness", o->declaration.handedness, "right, left, unknown")
      ->check(CLI::IsMember({"right", "left", "unknown"}))
      ->capture_default_str();
  command->add_option("--outcome", o->outcome, "completed, abandoned, stopped")
      ->check(CLI::IsMember({"completed", "abandoned", "stopped"}))
      ->capture_default_str();
  command->add_option("--start", o->declaration.startUtc, "when it began: 2026-01-31T12:00:00Z")
      ->check([](const std::string& text) {
        return recorder::isDate(text) ? std::string() : std::string("2026-01-31T12:00:00Z is wanted");
      });
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] {
    run = [o] {
      o->declaration.mode = o->mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice;
      o->declaration.outcome = o->outcome == "completed"   ? recorder::Outcome::completed
                               : o->outcome == "abandoned" ? recorder::Outcome::abandoned
                                                           : recorder::Outcome::stopped;
      return import(*o);
    };
  });
}

}  // namespace calot::apps

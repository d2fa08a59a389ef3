// SPDX-License-Identifier: GPL-3.0-or-later
// calot import: motion without a scene into a cohort.
#include <fmt/format.h>

#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "analytics/assess.h"
#include "analytics/checkpoints/from_samples.h"
#include "analytics/import_motion.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/motion_import.h"
#include "apps/calot/results.h"
#include "apps/calot/value_report.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/sources/column_map.h"

namespace calot::apps {

namespace {

struct ImportOptions {
  std::vector<std::string> files;
  std::string manifest, cohort, columns, mode = "practice", outcome = "stopped";
  analytics::MotionDeclaration declaration;
  MetricOptions metrics;
  double cutoff = 0.0;
  bool json = false;
};

/// Reads first, so that a file that cannot be read makes no database.
ImportedFile importOne(const std::string& file, const ImportOptions& o, const std::optional<recorder::ColumnMap>& map,
                       const std::vector<analytics::MetricScript>& metrics,
                       std::optional<analytics::CohortDatabase>& database) {
  return importFile([&] { return readMotion(file, map ? &*map : nullptr); },
                    [&](ImportedFile& result) {
                      if (!o.cohort.empty()) {
                        storeImported(o.cohort, database, o.declaration, metrics, result);
                        return;
                      }
                      result.external = analytics::externalOf(*result.motion, o.declaration, metrics);
                      result.values = analytics::valuesFromSamples(
                          *result.motion, {o.declaration.outcome, o.declaration.handedness, o.cutoff});
                      result.addExternal();
                    });
}

std::string summaryOf(const recorder::TrackedMotion& motion) {
  return fmt::format("{:.2f} s, {} rows", motion.time.back(), motion.time.size());
}

int import(const ImportOptions& o) {
  checkStored(o.cohort, o.cutoff);
  std::optional<recorder::ColumnMap> map;
  if (!o.columns.empty()) map = recorder::readColumnMap(o.columns);
  const std::vector<analytics::MetricScript> metrics = readMetrics(o.metrics);
  checkMetrics(metrics, o.cohort);
  std::optional<analytics::CohortDatabase> database;
  std::vector<ExitCode> codes;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  Progress progress("importing, files", o.json);
  for (const std::string& file : o.files) {
    const ImportedFile result = importOne(file, o, map, metrics, database);
    codes.push_back(worstOf({result.code, reportFailures(result.external, file)}));
    progress.show(codes.size(), o.files.size());
    Progress::erase();
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
    printResult("import", {{"files", list}});
  } else if (database) {
    analytics::printAttempts(*database, std::cout);
  }
  return static_cast<int>(worstOf(codes));
}

/// For CLI::Option::check.
std::function<std::string(const std::string&)> wordOf(const char* field) {
  return [field](const std::string& word) {
    analytics::MotionDeclaration ignored;
    return analytics::declareMotion(ignored, field, word);
  };
}

}  // namespace

void addImport(CLI::App& app, Run& run) {
  auto o = std::make_shared<ImportOptions>();
  CLI::App* command = app.add_subcommand(
      "import", "Computes the motion checkpoints of motion without a scene and stores them in a cohort.");
  CLI::Option* manifest = command->add_option(
      "--manifest", o->manifest,
      "A CSV table instead of files: a row each with file, participant, group, task, start, outcome, experience and "
      "what the options below say; these stand for what it leaves out");
  command->add_option("files", o->files, "two-handed motion, 76 columns at 30 Hz; or CSV files with --columns")
      ->excludes(manifest);
  addStoring(*command, o->cohort, o->cutoff);
  addMetrics(*command, o->metrics);
  command->add_option("--columns", o->columns, "a JSON file that says what the columns of the CSV files are");
  command->add_option("--task", o->declaration.task, "what was done; attempts of different tasks are never compared")
      ->check(wordOf("task"))
      ->capture_default_str();
  command->add_option("--participant", o->declaration.participant, "pseudonym")->check(wordOf("participant"));
  command->add_option("--mode", o->mode, "practice or assessment")
      ->check(oneOf({"practice", "assessment"}))
      ->capture_default_str();
  command->add_option("--purpose", o->declaration.purpose, "training, study, demo")
      ->check(oneOf({"training", "study", "demo"}))
      ->capture_default_str();
  command->add_option("--handedness", o->declaration.handedness, "right, left, unknown")
      ->check(oneOf({"right", "left", "unknown"}))
      ->capture_default_str();
  command->add_option("--outcome", o->outcome, "completed, abandoned, stopped")
      ->check(oneOf({"completed", "abandoned", "stopped"}))
      ->capture_default_str();
  command->add_option("--start", o->declaration.startUtc, "when it began: 2026-01-31T12:00:00Z")
      ->check(wordOf("start"));
  command->add_flag("--json", o->json, "print the result as JSON");
  command->callback([o, &run] {
    run = [o] {
      analytics::declareMotion(o->declaration, "mode", o->mode);
      analytics::declareMotion(o->declaration, "outcome", o->outcome);
      if (o->files.empty() && o->manifest.empty())
        throw Error(ErrorKind::invalid, "import: name motion files, or a table of them with --manifest");
      if (o->manifest.empty()) return import(*o);
      if (o->cohort.empty() || o->cutoff > 0.0)
        throw Error(ErrorKind::invalid, "import: --manifest stores what it names: give --cohort, and no --cutoff");
      return importManifest({o->manifest, o->cohort, o->columns, o->declaration, o->metrics, o->json});
    };
  });
}

}  // namespace calot::apps

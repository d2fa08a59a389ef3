// SPDX-License-Identifier: GPL-3.0-or-later
// Import of each motion file, named on the command line or by a manifest.
// Users' own metrics on the command line: options, and what is said of scripts that failed.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "analytics/import_motion.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::apps {

struct MetricOptions {
  std::vector<std::string> files;
  analytics::ScriptLimits limits;
};

/// Adds --metric, --metric-seconds, --metric-memory. @param options outlives the parsing.
CLI::Option* addMetrics(CLI::App& command, MetricOptions& options);

/// The scripts, run once for their declarations; what they print goes to stderr, a line with the script's name.
std::vector<analytics::MetricScript> readMetrics(const MetricOptions& options);

/// @throws Error (refused) naming the script where the cohort has its version with another source.
void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const analytics::CohortDatabase& database);
/// The same of a cohort that will be written to; nothing to check where there is none yet.
void checkMetrics(const std::vector<analytics::MetricScript>& metrics, const std::string& cohort);

/// Prints each failure on stderr. @return the exit code of all
ExitCode reportFailures(const analytics::MetricOutcomes& outcomes, const std::string& attempt);
/// The same as texts.
nlohmann::ordered_json failuresJson(const analytics::MetricOutcomes& outcomes);

/// Result for one file.
struct ImportedFile {
  ExitCode code = ExitCode::yes;
  std::string how = "not stored", error;
  std::optional<recorder::TrackedMotion> motion;
  std::vector<analytics::CheckpointValue> values;
  analytics::MetricOutcomes external;

  void addExternal() { values.insert(values.end(), external.values.begin(), external.values.end()); }
};

/// @param map of a CSV file, or null. @throws Error as the readers; (invalid) for a CSV file without a map.
recorder::TrackedMotion readMotion(const std::filesystem::path& file, const recorder::ColumnMap* map);

/// Runs `read`, then `store`. A damaged file, or a conflict when it is stored, is the file's own result; what ends
/// every file (a wrong command line, a database that cannot be used) is thrown.
ImportedFile importFile(const std::function<recorder::TrackedMotion()>& read,
                        const std::function<void(ImportedFile&)>& store);

/// Computes the users' own metrics of `file.motion`, makes or opens the cohort if it is not open yet, stores all values
/// and says in `file` what came of it.
void storeImported(const std::string& cohort, std::optional<analytics::CohortDatabase>& database,
                   const analytics::MotionDeclaration& declaration, const std::vector<analytics::MetricScript>& metrics,
                   ImportedFile& file);

/// A row of the output with --json.
nlohmann::ordered_json jsonOf(const std::string& file, const ImportedFile& result);

struct ManifestOptions {
  std::string manifest, cohort, columns;
  analytics::MotionDeclaration otherwise;  ///< where the manifest says nothing
  MetricOptions metrics;
  bool json = false;
};

/// `calot import --manifest`. @return the exit code
int importManifest(const ManifestOptions& options);

/// One line on stderr for each wrong row of a manifest, of at most twenty. @return the exit code
int refuseRows(const std::vector<Error>& faults);

}  // namespace calot::apps

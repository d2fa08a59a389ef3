// SPDX-License-Identifier: GPL-3.0-or-later
// Motion files and users' own metrics on the command line: options, reading, reports of failures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/assess.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "apps/calot/command.h"
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
Json failuresJson(const analytics::MetricOutcomes& outcomes);

/// @param map of a CSV file, or null. @throws Error as the readers; (invalid) for a CSV file without a map.
recorder::TrackedMotion readMotion(const std::filesystem::path& file, const recorder::ColumnMap* map);

/// One line on stderr for each wrong row of a manifest, of at most twenty. @return the exit code
ExitCode refuseRows(const std::vector<Error>& faults);

}  // namespace calot::apps

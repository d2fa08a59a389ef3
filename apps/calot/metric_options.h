// SPDX-License-Identifier: GPL-3.0-or-later
// Users' own metrics on the command line: options, and what is said of scripts that failed.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "apps/common/exit_code.h"

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

}  // namespace calot::apps

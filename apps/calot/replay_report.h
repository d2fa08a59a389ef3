// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands: reports of replays, of stored and shown values, of values that were computed again; motion files
// and users' own metrics.
#pragma once

#include <string>
#include <vector>

#include "analytics/assess.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "analytics/regrade.h"
#include "apps/calot/command.h"
#include "recorder/replay.h"
#include "recorder/sources/column_map.h"

namespace calot::apps {

/// "R.h5: bit-exact, 46.70 s (4670 steps), 12.3 x real time", and a line more where steps missed a tolerance; what is
/// not exact goes to stderr.
void printReport(const recorder::ReplayReport& report);

struct JunitOptions {
  std::string file;            ///< empty: none
  bool skipUndecided = false;  ///< recordings of another simulation version are skipped tests, which CI shows as green
  bool force = false;          ///< replace a file that is there
};

/// Adds `--junit`, `--skip-other-versions` and `--force`.
void addJunitOptions(CLI::App& command, JunitOptions& options);

/// Writes JUnit XML where a file is named: one case a recording; diverged is a failure, damaged an error, undecided an
/// error too unless it is to be skipped, the divergence in the body.
/// @throws Error (invalid) where the file exists and is not to be replaced; (failure) where it cannot be written.
void writeJunit(const JunitOptions& options, const std::string& suite,
                const std::vector<recorder::ReplayReport>& reports);

nlohmann::json reportJson(const recorder::ReplayReport& report);

/// How many steps missed a tolerance, by what was missed.
Json missesJson(const recorder::StepMisses& misses);

/// Exit code over many recordings, as worstOf of their codes.
ExitCode worstOf(const std::vector<recorder::ReplayReport>& reports);

/// The report of `calot regrade` and of `calot cohort merge --newer`: on stdout each changed value, how many attempts
/// each checkpoint changed in, and a line of counts, or JSON; on stderr one line for each attempt with a fault.
/// @returns the faults' exit code
ExitCode reportRegrade(const std::string& cohort, const analytics::Regrade& regrade, bool json);

/// "added", "unchanged", "extended".
const char* importedName(analytics::Imported imported);

/// A row for each value: its name, subject, version, number or the reason why there is none, filter, interval.
Json jsonOf(const std::vector<analytics::CheckpointValue>& values,
            const std::vector<analytics::ValueInterval>& intervals = {});

/// Adds --cohort, where values are stored, and --cutoff, with which they are only shown.
/// @param[out] cutoff Hz; 0: not given
void addStoring(CLI::App& command, std::string& cohort, double& cutoff);
/// Stored values have one filter: one of both options is needed. @throws Error (invalid)
void checkStored(const std::string& cohort, double cutoff);

/// Fault of a recording's signature where the cohort registers its station's key; empty: it is in order.
std::string keyFaultOf(const analytics::AttemptRecord& attempt, const std::string& cohort);

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

// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands that compute checkpoints: storing or showing values, and values as JSON.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "apps/common/program.h"
#include "recorder/replay.h"

namespace calot::apps {

/// "R.h5: bit-exact, 46.70 s (4670 steps), 12.3 x real time", and a line more where steps missed a tolerance; what is
/// not exact goes to stderr.
void printReport(const recorder::ReplayReport& report);

/// Adds `--junit`, `--skip-other-versions` and `--force`.
void addJunitOptions(CLI::App& command, std::string& file, bool& skipUndecided, bool& force);

nlohmann::json reportJson(const recorder::ReplayReport& report);

/// How many steps missed a tolerance, by what was missed.
nlohmann::ordered_json missesJson(const recorder::StepMisses& misses);

/// Exit code over many recordings, as worstOf of their codes.
ExitCode worstOf(const std::vector<recorder::ReplayReport>& reports);

/// "added", "unchanged", "extended".
const char* importedName(analytics::Imported imported);

/// A row for each value: its name, subject, version, number or the reason why there is none, filter, interval.
nlohmann::ordered_json jsonOf(const std::vector<analytics::CheckpointValue>& values,
                              const std::vector<analytics::ValueInterval>& intervals = {});

/// Adds --cohort, where values are stored, and --cutoff, with which they are only shown.
/// @param[out] cutoff Hz; 0: not given
void addStoring(CLI::App& command, std::string& cohort, double& cutoff);
/// Stored values have one filter: one of both options is needed. @throws Error (invalid)
void checkStored(const std::string& cohort, double cutoff);

/// Where a station's key is registered in the cohort, its recordings are signed by it; empty: nothing to say.
std::string keyFaultOf(const analytics::AttemptRecord& attempt, const std::string& cohort);

}  // namespace calot::apps

// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands that compute checkpoints: storing or showing values, and values as JSON.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::apps {

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

}  // namespace calot::apps

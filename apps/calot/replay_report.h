// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/exit_code.h"
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

}  // namespace calot::apps

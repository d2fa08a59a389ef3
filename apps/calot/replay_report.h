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
nlohmann::ordered_json missesJson(const recorder::StepMisses& misses);

/// Exit code over many recordings, as worstOf of their codes.
ExitCode worstOf(const std::vector<recorder::ReplayReport>& reports);

}  // namespace calot::apps

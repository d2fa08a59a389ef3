// SPDX-License-Identifier: GPL-3.0-or-later
// What commands that work in shares have in common: options, and what is said of plan, share and shards that are
// missing (docs/how-to/cluster.md).
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "analytics/regrade_shares.h"
#include "apps/common/exit_code.h"

namespace calot::apps {

struct ShareOptions {
  std::string shard;              ///< "3/8"
  std::string valuesTo;           ///< file of that share
  std::vector<std::string> take;  ///< values files
  std::uint32_t plan = 0;         ///< number of shards; 0: no plan is asked for
  bool force = false;

  /// Is the whole work to be done here and now?
  [[nodiscard]] bool none() const { return shard.empty() && take.empty() && plan == 0; }
};

/// Adds --shard with --values-to, --take, --plan and --force.
void addSharing(CLI::App& command, ShareOptions& options);

void printPlan(const std::vector<analytics::PlannedShare>& plan, bool json);
/// "V: shard 3 of 8, 157 recordings (12 of an earlier run), 2 missing".
void printShare(const ShareOptions& options, const analytics::ComputedShare& share, bool json);

/// One line on stderr for each file that was refused, and one for shards that are missing. @returns their exit code
ExitCode reportShards(const std::string& cohort, const std::vector<Error>& refused,
                      const analytics::MissingShares& missing);

/// Names as paths.
std::vector<std::filesystem::path> pathsOf(const std::vector<std::string>& names);

}  // namespace calot::apps

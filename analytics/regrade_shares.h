// SPDX-License-Identifier: GPL-3.0-or-later
// Regrading a cohort in shares, on as many machines as there are: each computes a share into a values file and writes
// no cohort; one program takes them all (docs/how-to/cluster.md, schemas/values.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analytics/regrade.h"
#include "analytics/shards/shard.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// One share as the plan has it.
struct PlannedShare {
  Shard shard;
  std::uint64_t recordings = 0;
  double seconds = 0.0;  ///< of recorded time
};

/// How a cohort's attempts are divided. @throws Error as CohortDatabase does
std::vector<PlannedShare> regradePlan(const std::string& cohort, std::uint32_t shares);

/// What computing a share gave.
struct ComputedShare {
  std::uint64_t recordings = 0;  ///< of the share
  std::uint64_t before = 0;      ///< of them, done by an earlier run
  std::uint64_t missing = 0;     ///< attempts without a recording
  double resimulation = 0.0;     ///< what judging the recordings took, all threads together (s)
};

/// Re-simulates the recordings of a share of the cohort's attempts and writes what they gave to a values file. The
/// cohort is only read, at the beginning. A run that was cut short is taken up; a file that is complete stays.
/// @param jobs recordings at a time; 0: one for each processor
/// @param replace a complete file
/// @throws Error as CohortDatabase and ValuesWriter do; damaged where a place is not there
ComputedShare computeRegradeShare(const std::string& cohort, const std::vector<std::filesystem::path>& places,
                                  const Shard& shard, const std::filesystem::path& values, unsigned jobs, bool replace,
                                  const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

/// Shares of which no file was taken, and what that leaves out.
struct MissingShares {
  std::vector<std::uint32_t> numbers;
  std::uint32_t of = 0;
  std::uint64_t attempts = 0;  ///< without new values, for want of a share
};

struct TakenRegrade {
  Regrade regrade;             ///< as regrade() gives it
  std::vector<Error> refused;  ///< files that were not taken: nothing of them was
  MissingShares missing;
  std::uint64_t withdrawn = 0;  ///< attempts that left the cohort after the shares were computed
};

/// Brings a cohort up to date with values files: what regrade() on one machine would have stored, in the same order.
/// Each attempt is stored whole or not at all; taking a file again changes nothing. A file of other definitions, of
/// another simulation version, of another cohort or damaged is refused as a whole.
/// @throws Error as CohortDatabase does
TakenRegrade takeRegrade(const std::string& cohort, const std::vector<std::filesystem::path>& files,
                         const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// Assessing folders of recordings in shares, as cohorts are regraded in shares (regrade_shares.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analytics/regrade_shares.h"
#include "analytics/shards/shard.h"
#include "analytics/shards/values_row.h"

namespace calot::analytics {

/// Recordings among files and in folders and below, by name: files that are named, and all HDF5 files of folders.
/// @throws Error (damaged) where a place is not there, or no recording in any
std::vector<std::filesystem::path> recordingsUnder(const std::vector<std::filesystem::path>& places);

/// How recordings are divided, by their sizes. Recorded time is not known before they are read: seconds are 0.
/// @throws Error (damaged) where a place is not there
std::vector<PlannedShare> assessPlan(const std::vector<std::filesystem::path>& places, std::uint32_t shares);

/// Re-simulates a share of the recordings and writes what they gave to a values file. Every share has to see the same
/// recordings in the same places.
/// @throws Error as ValuesWriter does; damaged where a place is not there
ComputedShare computeAssessShare(const std::vector<std::filesystem::path>& places, const Shard& shard,
                                 const std::filesystem::path& values, unsigned jobs, bool replace,
                                 const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

struct TakenAssess {
  std::vector<Error> refused;          ///< files that were not taken: nothing of them was
  std::vector<std::uint32_t> missing;  ///< shares of which there is no file
  std::uint32_t shares = 0;            ///< of the plan; 0: every file was refused
};

/// Hands over every recording of values files, in the order that assessing the folders on one machine has. Files are
/// refused as takeRegrade() does.
TakenAssess takeAssess(const std::vector<std::filesystem::path>& files,
                       const std::function<void(const ValuesRow& row)>& take);

}  // namespace calot::analytics

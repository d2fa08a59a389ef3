// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Writes a recording as CSV files into a folder: a file for each group of data sets (ticks_left.csv, camera.csv,
/// steps.csv, observables_organs.csv ...), events.csv and attempt.csv. A row a tick or step; units stand in the header
/// in round brackets; numbers have 17 significant digits (9 for those stored in 4 bytes), so that reading them gives
/// the same bits. The files get their names only when all are written.
/// @param force replace files that are there. @param progress called with steps done, or empty.
/// @return the files' paths. @throws Error invalid (files are there and force is not set), damaged, failure.
std::vector<std::filesystem::path> exportCsv(Recording& recording, const std::filesystem::path& folder, bool force,
                                             const std::function<void(std::uint64_t)>& progress = {});

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets of a recording as whole columns, for the Python module, and as CSV files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "recorder/recording/reader.h"

namespace calot::recorder {

/// One data set's values, row after row, little-endian and without padding.
struct RecordedColumn {
  std::string path;                ///< "/ticks/left/position"
  std::string type;                ///< of an element: "u1" to "u8", "i8", "f4", "f8"
  std::string unit;                ///< "m"; empty: none
  std::uint64_t width = 1;         ///< elements a row
  bool vector = false;             ///< shape (N, width) rather than (N)
  std::vector<std::string> parts;  ///< whose value each element of a row is: names of organs, vessels, fields; or empty
  std::vector<std::byte> values;
};

struct RecordedColumns {
  std::vector<RecordedColumn> ticks;  ///< a row a tick: /ticks and /camera
  std::vector<RecordedColumn> steps;  ///< a row a step: /steps and /observables
  std::vector<std::byte> events;      ///< packed as schemas/recording.md says: 45 bytes each
};

std::vector<std::byte> packedEvents(const std::vector<Event>& events);

/// Reads the columns of every step. @throws Error as Recording::step() does
RecordedColumns recordedColumns(Recording& recording);

/// A hand's raw samples, packed: 99 bytes each. @throws Error as Recording::rawSamples() does
std::vector<std::byte> packedRawSamples(Recording& recording, Hand hand);

/// Writes a recording as CSV files into a folder: a file for each group of data sets (ticks_left.csv, camera.csv,
/// steps.csv, observables_organs.csv ...), events.csv and attempt.csv. A row a tick or step; units stand in the header
/// in round brackets; numbers have 17 significant digits (9 for those stored in 4 bytes), so that reading them gives
/// the same bits. The files get their names only when all are written.
/// @param force replace files that are there. @param progress called with steps done, or empty.
/// @return the files' paths. @throws Error invalid (files are there and force is not set), damaged, failure.
std::vector<std::filesystem::path> exportCsv(Recording& recording, const std::filesystem::path& folder, bool force,
                                             const std::function<void(std::uint64_t)>& progress = {});

}  // namespace calot::recorder

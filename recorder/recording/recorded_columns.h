// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets of a recording, for readers of whole columns such as the Python module.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// All of a recording's rows.
struct RecordedColumns {
  std::vector<RecordedColumn> ticks;  ///< a row a tick: /ticks and /camera
  std::vector<RecordedColumn> steps;  ///< a row a step: /steps and /observables
  std::vector<std::byte> events;      ///< packed as schemas/recording.md says: 45 bytes each
};

/// Bytes of an event, and of a device's raw sample, as they are packed.
inline constexpr std::size_t packedEventBytes = 45;
inline constexpr std::size_t packedRawSampleBytes = 99;

/// Events in their packed form.
std::vector<std::byte> packedEvents(const std::vector<Event>& events);

/// Reads the columns of every step. @throws Error as Recording::step() does
RecordedColumns recordedColumns(Recording& recording);

/// A hand's raw samples, packed: 99 bytes each. @throws Error as Recording::rawSamples() does
std::vector<std::byte> packedRawSamples(Recording& recording, Hand hand);

}  // namespace calot::recorder

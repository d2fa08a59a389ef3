// SPDX-License-Identifier: GPL-3.0-or-later
// Strict reading of JSON objects into structs, by the table of their fields (sim/math/record.h).
#pragma once

#include "recorder/base/json_reader.h"

namespace calot::recorder {

/// Reads an object of a file: no unknown key, no missing one, each value of its type and within its range. Fields that
/// the file omits keep their values; records that it states begin at their defaults. Records without any key are left
/// to the caller. Faults are noted where they are noted (JsonFaults).
/// @throws Error (damaged) naming file and JSON pointer
void readRecord(const JsonPlace& place, const Record& record, void* object);

template <class T>
void readRecord(const JsonPlace& place, T& object) {
  readRecord(place, recordOf<T>(), &object);
}

}  // namespace calot::recorder

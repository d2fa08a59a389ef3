// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of structs, read strictly and written, by the table of their fields (sim/math/record.h).
#pragma once

#include <nlohmann/json.hpp>

#include "recorder/base/json_reader.h"
#include "sim/math/record.h"

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

/// JSON that readRecord() reads. A value that is stored nowhere is null, for the caller to fill in, unless its field
/// admits one value alone.
nlohmann::ordered_json writeRecord(const Record& record, const void* object);

template <class T>
nlohmann::ordered_json writeRecord(const T& object) {
  return writeRecord(recordOf<T>(), &object);
}

}  // namespace calot::recorder

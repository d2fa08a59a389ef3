// SPDX-License-Identifier: GPL-3.0-or-later
// JSON of structs, by the table of their fields (sim/math/record.h), in its order.
#pragma once

#include <nlohmann/json.hpp>

#include "sim/math/record.h"

namespace calot::recorder {

/// JSON that readRecord() reads. A value that is stored nowhere is null, for the caller to fill in, unless its field
/// admits one value alone.
nlohmann::ordered_json writeRecord(const Record& record, const void* object);

template <class T>
nlohmann::ordered_json writeRecord(const T& object) {
  return writeRecord(recordOf<T>(), &object);
}

}  // namespace calot::recorder

// SPDX-License-Identifier: GPL-3.0-or-later
// JSON Schema (draft 2020-12) of files that records describe (sim/math/record.h).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/math/record.h"

namespace calot::structure {

/// @param page of the documentation that explains such files
/// @param elsewhere records of objects whose values the file's structs hold otherwise, by the same name
nlohmann::ordered_json jsonSchema(const std::string& title, const std::string& page, const Record& root,
                                  const std::vector<const Record*>& elsewhere = {});

}  // namespace calot::structure

// SPDX-License-Identifier: GPL-3.0-or-later
// One recording in a values file (schemas/values.md).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assess.h"
#include "analytics/shards/values_header.h"

namespace calot::analytics {

struct ValuesRow {
  std::uint64_t position = 0;  ///< in the list that was divided: rows are stored in this order
  std::string attempt;         ///< uuid; may be empty where a recording of a folder cannot be read
  std::string file;            ///< as it was found, or as the cohort knows it
  /// What re-simulating it gave; none where an attempt's recording was in none of the places.
  std::optional<JudgedRecording> judged;
};

/// @param header of the file: what a value has of its definition is not repeated
nlohmann::ordered_json jsonOf(const ValuesRow& row, const ValuesHeader& header);
/// @param file for messages. @throws Error (damaged)
ValuesRow valuesRow(const nlohmann::json& row, const ValuesHeader& header, const std::string& file);

}  // namespace calot::analytics

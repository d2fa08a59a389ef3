// SPDX-License-Identifier: GPL-3.0-or-later
// Checked cells of a table, as a study needs them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analytics/report/csv_table.h"
#include "analytics/report/table_study.h"

namespace calot::analytics {

/// A column that is compared.
struct Outcome {
  std::string name;
  Direction direction = Direction::none;
  std::size_t column = 0;
};

/// Data of one row for the study.
struct Record {
  std::size_t line = 0;
  std::string participant, group, occasion;   ///< group: empty without a column of groups
  std::vector<std::optional<double>> values;  ///< by outcome
};

/// @throws Error (invalid) for a column that is not there or is named twice, or a word behind the colon that is none.
std::vector<Outcome> outcomesOf(const CsvTable& table, const TableStudyOptions& options);

/// @throws Error (invalid) for a column that is not there; Error (damaged), naming line and column, for a row without
/// participant or occasion, a name with control characters, a cell that is no finite number.
std::vector<Record> recordsOf(const CsvTable& table, const TableStudyOptions& options,
                              const std::vector<Outcome>& outcomes);

/// @throws Error (invalid) where an occasion is named that no row has.
void askForOccasion(const CsvTable& table, const std::vector<Record>& records, const std::string& occasion);

}  // namespace calot::analytics

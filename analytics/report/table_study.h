// SPDX-License-Identifier: GPL-3.0-or-later
// A study of an imported table: one row per participant, or per participant and occasion.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analytics/report/study.h"
#include "recorder/base/csv.h"

namespace calot::analytics {

/// A protocol overrides groups, the better one, attempt rule and family.
struct TableStudyOptions : StudyChoices {
  std::optional<Protocol> protocol;
  std::string participantColumn, groupColumn;
  std::vector<std::string> occasionColumns;  ///< an occasion is these cells, joined with "/"
  std::string occasion;                      ///< the one that is compared; empty: all rows
  std::string baselineOccasion;              ///< where the outcome's baseline stands, or empty
  /// Columns, each with ":lower" or ":higher" behind it where it judges; empty, with a protocol: those of its
  /// hypotheses that are there.
  std::vector<std::string> outcomes;
};

/// Two groups side by side, one value per participant. An empty outcome cell is a missing value, and whoever has no row
/// at an occasion where others have one is named. With a baseline the outcome is also compared by analysis of
/// covariance. A protocol's hypothesis is about the column of its outcome's name, or of its checkpoint's and subject's
/// ("path-length left"); the study stays exploratory, for a table does not say when its figures came about.
/// @throws Error (invalid) for a column or occasion that is not there, Error (damaged) for a cell that is no finite
/// number, Error (refused) when there are not two independent groups or a participant has several rows and there is no
/// rule: rows of one person are not independent.
Study makeTableStudy(const CsvTable& table, const TableStudyOptions& options);

/// @throws Error (damaged) naming line and column.
[[noreturn]] void failAt(const CsvTable& table, std::size_t line, const std::string& column, const std::string& what);

/// A column that is compared.
struct Outcome {
  std::string name;
  Direction direction = Direction::none;
  std::size_t column = 0;
};

/// Data of one row for the study.
struct TableRecord {
  std::size_t line = 0;
  std::string participant, group, occasion;   ///< group: empty without a column of groups
  std::vector<std::optional<double>> values;  ///< by outcome
};

/// @throws Error (invalid) for a column that is missing or named twice, or an unknown word behind the colon.
std::vector<Outcome> outcomesOf(const CsvTable& table, const TableStudyOptions& options);

/// @throws Error (invalid) for a column that is not there; Error (damaged), naming line and column, for a row without
/// participant or occasion, a name with control characters, a cell that is no finite number.
std::vector<TableRecord> recordsOf(const CsvTable& table, const TableStudyOptions& options,
                                   const std::vector<Outcome>& outcomes);

/// Columns that a study or a design of a table needs. @throws Error (invalid)
void checkColumns(const TableStudyOptions& options, bool needsGroup);

/// How many rows each group has, and how many have none.
struct RowsByGroup {
  std::map<std::string, std::uint64_t> present;
  std::uint64_t ungrouped = 0;
  std::string left;  ///< " (2 rows have none)", or empty
};
RowsByGroup rowsByGroup(const std::vector<TableRecord>& records);

/// Adds the reasons for which rows went out.
void addReasons(std::vector<FlowRow>& flow, const std::vector<FlowRow>& counted);

/// @throws Error (invalid) where an occasion is named that no row has.
void askForOccasion(const CsvTable& table, const std::vector<TableRecord>& records, const std::string& occasion);

}  // namespace calot::analytics

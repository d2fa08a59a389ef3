// SPDX-License-Identifier: GPL-3.0-or-later
// A study of a table from elsewhere: one row per participant, or per participant and occasion.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/csv_table.h"
#include "analytics/report/study.h"

namespace calot::analytics {

struct TableStudyOptions : StudyChoices {
  std::string participantColumn, groupColumn;
  std::vector<std::string> occasionColumns;  ///< an occasion is these cells, joined with "/"
  std::string occasion;                      ///< the one that is compared; empty: all rows
  std::string baselineOccasion;              ///< where the outcome's baseline stands, or empty
  std::vector<std::string> outcomes;         ///< columns, each with ":lower" or ":higher" behind it where it judges
};

/// Two groups side by side, one value per participant. An empty outcome cell is a missing value, and whoever has no row
/// at an occasion where others have one is named. With a baseline the outcome is also compared by analysis of
/// covariance.
/// @throws Error 2 for a column or occasion that is not there, Error 4 for a cell that is no finite number, Error 3
/// when there are not two independent groups or a participant has several rows and there is no rule: rows of one person
/// are not independent.
Study makeTableStudy(const CsvTable& table, const TableStudyOptions& options);

}  // namespace calot::analytics

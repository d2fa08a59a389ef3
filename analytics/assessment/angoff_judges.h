// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/report/csv_reader.h"
#include "analytics/statistics/angoff.h"

namespace calot::analytics {

/// Judges' probabilities that a borderline trainee passes each figure, and the pass mark.
struct AngoffJudgement {
  std::vector<std::string> judges, items;
  RatingTable probabilities;  ///< a row a judge
  AngoffCut cut;
  std::size_t needed = 0;  ///< least whole number of items at or above the cut
};

/// Of a table with a column "judge" and a column for each item.
/// @throws Error (invalid) without such a column; Error (damaged), naming line and column, for a judge without a name
/// or named twice, and a cell that is no probability; Error (refused) where there is no cut.
AngoffJudgement readAngoff(const CsvTable& table);

}  // namespace calot::analytics

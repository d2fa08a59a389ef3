// SPDX-License-Identifier: GPL-3.0-or-later
// Figures that count in a norm's rule, and pass marks set by people: fixed ones and judges' (Angoff).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analytics/assessment/declared_document.h"
#include "analytics/cohort/assessment_database.h"
#include "analytics/statistics/standard_setting.h"
#include "recorder/base/csv.h"

namespace calot::analytics {

/// A pass mark that an instructor sets for what is critical, whatever the members' spread.
struct FixedCut {
  std::string figure;    ///< "clip-errors", or one of several, "path-length left"
  bool atLeast = false;  ///< else at most
  double value = 0.0;    ///< in the unit that tables show
};

/// A figure is named whole, or by its checkpoint's name.
inline bool isCalled(const std::string& wanted, const std::string& checkpoint, const std::string& subject) {
  return wanted == checkpoint || wanted == figureName(checkpoint, subject);
}

/// "critical-view>=1", "clip-errors<=0". @throws Error (invalid)
FixedCut parseFixedCut(const std::string& text);

/// Does a checkpoint count where the rule names none? Few do: how long it took, how far the tips went, and what harms
/// the patient. The others describe; hundreds of them would decide by what competent people happen to differ in.
bool countsByDefault(std::string_view checkpoint);
/// The six of them, harm first. The dashboard shows the same.
const std::vector<std::string_view>& countingCheckpoints();

/// Puts an instructor's marks in the place of those of the members' spread; these figures are in the rule.
/// @throws Error (invalid) where no figure is called so, or its better side is the other one
void setFixedCuts(Norm& norm, const std::vector<FixedCut>& fixed);
/// Was the mark set by a person? Such a figure has to be passed whatever number of others is.
bool isFixed(const NormCheckpoint& mark);

/// True if the rule is met: by enough of its figures, and by each that is fixed.
/// @param passed by Norm::checkpoints
bool keepsRule(const Norm& norm, const std::vector<bool>& passed);

/// Warning that names figures of harm which do not count, since they have no pass mark; or empty.
std::string uncountedWarning(const Norm& norm);

/// Judges' probabilities that a borderline trainee passes each figure, and the pass mark.
struct AngoffJudgement {
  std::vector<std::string> judges, items;
  RatingTable probabilities;  ///< a row a judge
  AngoffCut cut;
  std::size_t needed = 0;  ///< least whole number of items at or above the cut
};

/// Reads a table with a column "judge" and a column for each item.
/// @throws Error (invalid) without such a column; Error (damaged), naming line and column, for a judge without a name
/// or named twice, and a cell that is no probability; Error (refused) where there is no cut.
AngoffJudgement readAngoff(const CsvTable& table);

}  // namespace calot::analytics

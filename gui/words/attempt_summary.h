// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts for people: one in words, which an instructor reads first and which names a trainee's next goal; several,
// and their values, as tables for a terminal.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

struct AttemptSummary {
  enum class Safety { notAssessed, notSafe, noCriticalError };
  Safety safety = Safety::notAssessed;
  std::string verdict;              ///< how it ended and what verification found; with a grade, its verdict
  std::string criticalView;         ///< empty: the scene has none
  std::vector<std::string> errors;  ///< a sentence a severity, the gravest first; of those not assessed the first alone
};

/// @param grade of the attempt; null: it was not held against a norm
AttemptSummary summaryOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                         const analytics::Grade* grade);

/// A goal for the next attempt: the first figure that counts and that this attempt did not pass, critical errors and
/// fixed marks before others, then the one that fewest competent people fall behind.
struct NextGoal {
  std::string text;  ///< one sentence, or the reason why there is no value
  std::string checkpoint, subject;
};
NextGoal nextGoal(const analytics::Grade& grade);

/// Every value of one attempt, in display units, or the reason why there is none; with intervals, two columns more: the
/// interval, and what it is made of.
void printValues(const std::vector<analytics::CheckpointValue>& values,
                 const std::vector<analytics::ValueInterval>& intervals, std::ostream& out);

/// Closing table of `calot assess`: every attempt of the database with outcome, verification and the checkpoints that
/// ask for columns there (CheckpointPlace::summaryTitle), without those that no attempt has; synthetic ones are marked.
void printAttempts(const analytics::CohortDatabase& database, std::ostream& out);

}  // namespace calot::gui

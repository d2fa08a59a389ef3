// SPDX-License-Identifier: GPL-3.0-or-later
// What an instructor wants to know of an attempt first, in words.
#pragma once

#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::analytics {

/// A checkpoint that counts (countingCheckpoints()), with its values: one, or one for each hand or organ.
struct KeyFigure {
  std::string checkpoint, title;
  std::vector<CheckpointValue> values;  ///< in the order of the attempt's
};

struct AttemptSummary {
  std::string verdict;             ///< how it ended and what verification found; with a grade, its verdict
  std::string criticalView;        ///< empty: the scene has none
  std::string errors;              ///< critical errors first, then what else went wrong
  std::vector<KeyFigure> figures;  ///< the five that count beside the critical view, those that the scene has
};

/// @param grade of the attempt; null: it was not held against a norm
AttemptSummary summaryOf(const AttemptRow& attempt, const std::vector<CheckpointValue>& values, const Grade* grade);

/// Whether a value is missing because the scene has nothing that it could be of ("the scene has no fat"): true of
/// every attempt on this scene.
bool sceneLacks(const CheckpointValue& value);

/// A goal for the next attempt: the first figure that counts and that this attempt did not pass, critical errors and
/// fixed marks before others, then the one that fewest competent people fall behind.
struct NextGoal {
  std::string text;  ///< one sentence; why there is none
  std::string checkpoint, subject;
};
NextGoal nextGoal(const Grade& grade);

}  // namespace calot::analytics

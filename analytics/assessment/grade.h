// SPDX-License-Identifier: GPL-3.0-or-later
// One attempt held against a norm, and its summary in words.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/moments.h"
#include "analytics/assessment/norm.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {

/// Percentile of a value among the n competent members with the figure: 100 (k + t / 2 + 1 / 2) / (n + 1), k of
/// them worse and t equal, beside what n people can tell: from 100 / (n + 1) to 100 n / (n + 1). No answer beyond the
/// best or the worst of them, and where there are fewer than leastForPercentile.
inline constexpr std::size_t leastForPercentile = 5;
Expected<double> percentile(const std::vector<double>& members, double value, Direction direction);

/// One of the participant's attempts in the history of a figure.
struct HistoryPoint {
  std::string attempt, startUtc;
  double value = 0.0;  ///< display unit
};

struct GradedFigure {
  NormCheckpoint mark;  ///< SI
  std::string title, unit;
  double displayFactor = 1.0;
  std::optional<double> value;  ///< SI
  std::string missing;          ///< why it is not judged, or empty
  std::optional<bool> passed;
  bool open = false;  ///< the value lies within the interval of the cut: another norm might judge otherwise
  std::optional<ValueInterval> interval;           ///< of the simulation, where one was worked out
  bool undecided = false;                          ///< the pass mark lies within it: not decided by this simulation
  Expected<double> rank = NoResult{"not judged"};  ///< percentile()
  std::uint64_t competent = 0;                     ///< members that rank is among
  FigureMoments moments;                           ///< of a weak figure
  std::vector<HistoryPoint> history;               ///< by start, this attempt the last
  Expected<LearningCurve> curve = NoResult{"not computed"};  ///< a - b / x, display unit

  [[nodiscard]] bool weak() const { return passed.has_value() && !*passed; }
};

struct Grade {
  AttemptRow attempt;
  Norm norm;
  PassRate competentRate, otherRate;  ///< of the norm's own members, by its rule
  std::optional<double> criticalErrors;
  std::string criticalMissing;        ///< why they are not known, or empty
  bool criticalUndecided = false;     ///< the simulation's interval holds no error and one
  std::vector<double> criticalTimes;  ///< begin of the moments at which they happened (s)
  std::vector<GradedFigure> figures;  ///< in the norm's order
  std::size_t inRule = 0, needed = 0, passedCount = 0;
  bool passed = false;
  bool certain = true;  ///< the judgement is the same however the open and undecided figures are taken
  std::string verdict;  ///< one sentence
  std::vector<std::string> remarks;
  std::string momentsMissing;  ///< why no recording was looked at, or empty
};

/// Critical errors first: one fails the attempt. Then the norm's rule. A figure without a value is not passed.
/// @param attempts the participant's other attempts of the same key, this one among them @param values theirs
/// @throws Error (refused) where the attempt did not verify or is not whole, or its comparability key is not the norm's
/// and `mixKeys` is not set.
Grade gradeAttempt(const AttemptRow& attempt, const std::vector<AttemptRow>& attempts,
                   const std::vector<AttemptValue>& values, const Norm& norm, bool mixKeys, const std::string& name);

/// Figures whose moments are to be found: weak ones, and critical errors where there are any.
std::vector<std::pair<std::string, std::string>> weakFigures(const Grade& grade);
void addMoments(Grade& grade, const std::vector<FigureMoments>& found);

/// "formative" until evidence is attached to the norm, then what it is.
std::string useOf(const Norm& norm);

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

/// True if a value is missing because the scene lacks its subject ("the scene has no fat"): true of
/// every attempt on this scene.
bool sceneLacks(const CheckpointValue& value);

/// A goal for the next attempt: the first figure that counts and that this attempt did not pass, critical errors and
/// fixed marks before others, then the one that fewest competent people fall behind.
struct NextGoal {
  std::string text;  ///< one sentence, or the reason why there is no value
  std::string checkpoint, subject;
};
NextGoal nextGoal(const Grade& grade);

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// One attempt held against a norm.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/moments.h"
#include "analytics/assessment/norm.h"
#include "analytics/assessment/norm_decision.h"
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
  std::optional<MarkError> error;         ///< beside the mark, on its scale
  bool near = false;                      ///< within that of the mark: another attempt might be judged otherwise
  std::optional<ValueInterval> interval;  ///< of the simulation, where one was worked out
  bool undecided = false;                 ///< the pass mark lies within it: not decided by this simulation
  Expected<double> rank = NoResult{"not judged"};            ///< percentile()
  std::uint64_t competent = 0;                               ///< members that rank is among
  FigureMoments moments;                                     ///< of a weak figure
  std::vector<HistoryPoint> history;                         ///< by start, this attempt the last
  Expected<LearningCurve> curve = NoResult{"not computed"};  ///< a - b / x, display unit

  [[nodiscard]] bool weak() const { return passed.has_value() && !*passed; }
};

struct Grade {
  AttemptRow attempt;
  Norm norm;
  std::optional<double> criticalErrors;
  std::string criticalMissing;        ///< why they are not known, or empty
  bool criticalUndecided = false;     ///< the simulation's interval holds no error and one
  std::string criticalNote;           ///< what they were and when, as the checkpoint's note
  std::vector<std::string> safety;    ///< the verdict's sentences, the gravest severity first
  std::vector<ErrorLine> errors;      ///< of the recording, where it was looked at, the gravest first
  std::vector<GradedFigure> figures;  ///< in the norm's order
  std::size_t inRule = 0, needed = 0, passedCount = 0;
  bool passed = false;
  bool near = false;    ///< within one standard error of its marks, the judgement is the other
  bool certain = true;  ///< the judgement is the same however the open and undecided figures are taken
  std::string verdict;  ///< one sentence
  std::vector<std::string> remarks;
  std::string momentsMissing;  ///< why no recording was looked at, or empty
};

/// Critical errors first: one fails the attempt. Then the norm's rule. A figure without a value is not passed.
/// @param attempts this one among them: the participant's give the history, and those of the key the errors of
/// measurement @param values theirs
/// @throws Error (refused) where the attempt did not verify or is not whole, or its comparability key is not the norm's
/// and `mixKeys` is not set.
Grade gradeAttempt(const AttemptRow& attempt, const std::vector<AttemptRow>& attempts,
                   const std::vector<AttemptValue>& values, const Norm& norm, bool mixKeys, const std::string& name);

/// Figures whose moments are to be found: the weak ones.
std::vector<std::pair<std::string, std::string>> weakFigures(const Grade& grade);
void addMoments(Grade& grade, AttemptMoments found);

/// "formative" until evidence is attached to the norm, then what it is.
std::string useOf(const Norm& norm);

}  // namespace calot::analytics

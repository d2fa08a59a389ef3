// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers behind charts of one checkpoint: over attempts by group, and from attempt to attempt of a participant.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/report/plots.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/regression.h"

namespace calot::gui {

enum class GroupBy { group, profile, participant };

/// A figure that a cohort holds: checkpoint and, for figures per hand or organ, whose.
struct Figure {
  std::string name;
  std::string subject;
  bool operator==(const Figure&) const = default;
};
/// Comparability keys of the attempts, the one with most attempts first, then by name.
[[nodiscard]] std::vector<std::string> comparabilityKeysOf(const std::vector<analytics::AttemptRow>& attempts);

struct ComparisonRequest {
  Figure figure;
  GroupBy groupBy = GroupBy::group;
  std::string comparabilityKey;  ///< attempts of other keys are left out: they cannot be compared
  bool includeSynthetic = true;
};

struct ComparisonPoint {
  std::string attempt;
  double value = 0.0;  ///< in Comparison::unit
  bool synthetic = false;
};

struct ComparisonGroup {
  std::string name;                    ///< "(none)" for attempts without one
  std::vector<ComparisonPoint> point;  ///< ascending by value, then attempt
};

struct Comparison {
  std::vector<ComparisonGroup> group;                           ///< by name
  std::string unit;                                             ///< displayed one
  const analytics::CheckpointDefinition* definition = nullptr;  ///< of the figure; null: not known
  bool synthetic = false;                                       ///< at least one point was made by a performer
  int shown = 0;                                                ///< attempts with a point
  std::vector<std::pair<std::string, int>> leftOut;  ///< reasons in the order in which they are asked, and attempts
};

/// Left out, in this order: another comparability key; what studies leave out (AttemptRow::leftOut), but for practice,
/// which a key says, attempts without group, and synthetic ones if included; another version of the checkpoint than the
/// newest present; no value.
[[nodiscard]] Comparison compare(const std::vector<analytics::AttemptRow>& attempts,
                                 const std::vector<analytics::AttemptValue>& values, const ComparisonRequest& request);

/// "12 attempts. Left out: 2 of another comparability key, 1 excluded."
[[nodiscard]] std::string captionOf(const Comparison& comparison);

/// A box plot of the groups; points of performers are hollow. None without a point.
[[nodiscard]] std::optional<analytics::Drawing> drawComparison(const Comparison& comparison, const std::string& title,
                                                               const analytics::PlotFrame& frame);

/// People with attempts: participants by pseudonym; behind them performers' profiles, whose runs are no one's learning.
struct Trainee {
  std::string name;
  bool synthetic = false;
  bool operator==(const Trainee&) const = default;
};
std::vector<Trainee> traineesOf(const std::vector<analytics::AttemptRow>& attempts);

/// One attempt in the history of a figure.
struct HistoryAttempt {
  const analytics::AttemptRow* attempt = nullptr;
  std::optional<double> value;  ///< in the unit that the checkpoint displays
  std::string why;              ///< there is none, or it is not shown in the curve
};

struct TraineeHistory {
  std::vector<HistoryAttempt> attempts;  ///< of one comparability key, by start
  std::string unit;
  const analytics::CheckpointDefinition* definition = nullptr;  ///< of the figure; null: not known
  /// Over the number of the attempt, from 1, of those with a value: a - b / x.
  analytics::Expected<analytics::LearningCurve> curve = analytics::NoResult{"not computed"};
  std::optional<double> cut;  ///< of the norm of this key, if there is one; display unit
  int otherKeys = 0;          ///< attempts of the same trainee that cannot stand beside these
};

/// Comparability keys of a trainee's attempts, the one with most first.
std::vector<std::string> keysOf(const std::vector<analytics::AttemptRow>& attempts, const Trainee& trainee);

/// Diverged and damaged attempts stand in the list and not in the curve, as do values of an older version of the
/// checkpoint than the newest one there. @param attempts, values outlive the history
TraineeHistory historyOf(const std::vector<analytics::AttemptRow>& attempts,
                         const std::vector<analytics::AttemptValue>& values, const std::vector<analytics::Norm>& norms,
                         const Trainee& trainee, const Figure& figure, const std::string& key);

/// Values over the number of the attempt, with curve, band and cut. None where there is nothing to show.
std::optional<analytics::Drawing> drawTraineeHistory(const TraineeHistory& history, const std::string& title,
                                                     const analytics::PlotFrame& frame);

}  // namespace calot::gui

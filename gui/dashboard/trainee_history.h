// SPDX-License-Identifier: GPL-3.0-or-later
// How a participant's figures went from attempt to attempt. Knows no window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/plots.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/regression.h"
#include "gui/dashboard/comparison.h"

namespace calot::gui {

/// Who made attempts: participants by pseudonym; behind them performers' profiles, whose runs are no one's learning.
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

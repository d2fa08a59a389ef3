// SPDX-License-Identifier: GPL-3.0-or-later
// A study made ready for a page: choices to options, tables to text, rows to plots, export. Knows no window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/report/study.h"
#include "gui/dashboard/comparison.h"

namespace calot::gui {

struct StudyRequest {
  analytics::StudyOptions options;  ///< groups: both empty for the only two that are there
  /// SHA-256 of a registered protocol, which makes all choices but the key; empty: none
  std::string protocol;
  bool check = true;  ///< the whole database first, as `calot cohort check`: a changed byte must not change a figure
};

/// The study, with ratings. Opens the database on its own: for a thread that is not the interface's.
/// @throws Error where there is none; what `progress` throws, which ends it
analytics::Study studyOf(const std::string& database, const StudyRequest& request,
                         const analytics::StudyProgress& progress = {});

/// Groups that attempts have, by name, for the choice of two.
std::vector<std::string> groupsOf(const std::vector<analytics::AttemptRow>& attempts, analytics::Grouping grouping);

/// Address under which a page shows the forest plot of studyText().
inline constexpr const char* forestAddress = "study:forest";

/// Title, registration, first result with its forest plot (forestAddress, where there is one), coverage by group, then
/// notes, flow, methods and all other tables, as HTML for a text widget; every text is escaped.
std::string studyText(const analytics::Study& study);

/// A point of a receiver operating characteristic: taking `threshold` and beyond as the first group's.
struct RocPoint {
  double falsePositive = 0.0;  ///< share of the second group taken for the first
  double truePositive = 0.0;   ///< share of the first group taken for it
};
struct RocCurve {
  std::vector<RocPoint> points;  ///< from (0, 0) to (1, 1)
  double area = 0.5;             ///< under it, by trapezoids: P(X > Y) + P(X = Y) / 2 in the curve's direction
  bool lowerIsPositive = false;  ///< small values are taken for the first group
};
/// The empirical curve of two groups' values (Fawcett 2006, Pattern Recognit. Lett. 27:861); ties go aslant.
/// @param lowerIsPositive small values speak for the first group. @pre both have a value, all finite
RocCurve rocOf(const std::vector<double>& first, const std::vector<double>& second, bool lowerIsPositive);
/// In the direction of the row's hypothesis; without one, larger values speak for the first group. @pre as rocOf()
RocCurve rocOf(const analytics::StudyRow& row);
/// The curve and its diagonal of no skill.
std::optional<analytics::Drawing> drawRoc(const RocCurve& curve, const std::string& title,
                                          const analytics::PlotFrame& frame);

/// Writes as `calot study --csv` (into a folder) or `--html` (a file) does, and notes in the database whose attempts
/// went out. What is there is replaced. @return a warning where that could not be noted, or empty
/// @throws Error where a file cannot be written
std::string exportStudy(const analytics::Study& study, const std::string& database, const std::string& target,
                        bool html);

}  // namespace calot::gui

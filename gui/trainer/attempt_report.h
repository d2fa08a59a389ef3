// SPDX-License-Identifier: GPL-3.0-or-later
// An attempt that has ended, in figures for whoever made it. No window.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <QString>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/stretch_figures.h"
#include "gui/words/attempt_summary.h"

namespace calot::gui {

/// An attempt and its figures, from the cohort where it is in it, else from what its recording says of itself.
struct AttemptFacts {
  analytics::AttemptRow attempt;
  std::vector<analytics::CheckpointValue> values;
  std::vector<analytics::ValueInterval> intervals;
  bool inCohort = false;
};

/// One figure that counts.
struct FigureReport {
  QString title;   ///< "Elapsed time"
  QString now;     ///< "41.2 s"
  QString norm;    ///< "pass mark 38.0 s, competent people 20.1 to 35.5 s: falls short", or empty
  QString before;  ///< "52.0 s, better by 10.8 s", or empty
};

struct AttemptReport {
  AttemptFacts facts;
  AttemptSummary summary;
  QString norm;      ///< what it is held against, and what that finds; or why there is none
  QString previous;  ///< which attempt it is compared with, or why there is none
  std::vector<FigureReport> figures;
};

/// @param file a recording that was written to its end @param cohort may not exist yet; empty: none
/// @throws Error as recorder::Recording and CohortDatabase
AttemptFacts readFacts(const std::filesystem::path& file, const std::filesystem::path& cohort);

/// The participant's attempt before this one at the same task: same comparability key, whole, no branch, and made by
/// the same kind of operator. None for an attempt without a pseudonym.
std::optional<AttemptFacts> previousInCohort(const AttemptFacts& now, const std::filesystem::path& cohort);

/// Norms of a cohort. @param cohort may not exist yet; empty: none
std::vector<analytics::Norm> normsOf(const std::filesystem::path& cohort);

/// @param previous none: there is none
AttemptReport reportOf(AttemptFacts now, const std::optional<AttemptFacts>& previous,
                       const std::vector<analytics::Norm>& norms);

/// Figures of a branch beside its parent's than its parent, from where it left it to the end of the shorter one.
struct Lesson {
  double seconds = 0.0;  ///< how long that is
  std::vector<StretchFigure> figures;
};
/// Reads both recordings. @throws Error as recorder::Recording; (refused) where they are not parent and branch
Lesson lessonOf(const std::filesystem::path& parent, const std::filesystem::path& branch);

}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
// The people of a cohort to whom a course is assigned, and how far each of them is.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/proficiency.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::analytics {

struct CoursePerson {
  std::string participant, group;
  std::vector<TaskStanding> tasks;                            ///< by Course::tasks
  std::vector<std::map<std::string, std::size_t>> uncounted;  ///< likewise: attempts that do not count, by reason
};

struct CourseProgress {
  Course course;
  std::string today;                       ///< "2026-01-31"
  std::vector<std::optional<Norm>> norms;  ///< by Course::tasks; none: the task has no criterion
  std::vector<CoursePerson> people;        ///< by pseudonym
  bool synthetic = false;                  ///< performers are in it, or in one of its norms
};

/// Holds the attempts of everybody to whom the course is assigned against its norms. An attempt passes if it was
/// completed and its grade passes. Attempts do not count that gradeAttempt() refuses, that are excluded by hand,
/// branches or goldens, that failed for technical reasons, of other comparability keys than the norm's or without a
/// known start.
/// @param file of the course, for faults
/// @param includeSynthetic performers' attempts under a participant's pseudonym, too
/// @throws Error (refused), naming file and JSON pointer, for a norm that is not in the cohort or is of another scene,
/// and for a group that no participant has.
CourseProgress courseProgress(const CohortDatabase& cohort, const Course& course, const std::string& file,
                              const std::string& today, bool includeSynthetic);

}  // namespace calot::analytics

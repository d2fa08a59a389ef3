// SPDX-License-Identifier: GPL-3.0-or-later
// How far the people of a course are, in the words and tables of terminal, window and paper.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analytics/assessment/course_progress.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {

/// "1/2", "0/2, behind", "proficient", "lapsed, 0/2"; "-" for not begun; of a task without a criterion the tries.
std::string standingCell(const CourseTask& task, const TaskStanding& standing);

/// Behind in one of the tasks.
bool isBehind(const CoursePerson& person);
/// "1 of 2": tasks that the person is proficient in, of those with a criterion; "-" where none has one.
std::string proficientOf(const Course& course, const CoursePerson& person);
/// The sentence on the first task that still lacks something; empty: nothing is missing.
std::string nextMissing(const CoursePerson& person);

/// People who are behind first, then by pseudonym.
std::vector<const CoursePerson*> behindFirst(const CourseProgress& progress);

/// A row for each person: participant, group where they differ, and a cell for each task.
ReportTable courseTable(const CourseProgress& progress, const std::vector<const CoursePerson*>& people);
/// "Behind: P3, Carve (due on 2026-02-01).": a sentence for each person who is behind, then for each whose retention
/// test is due.
std::vector<std::string> courseNotes(const CourseProgress& progress);
/// Attempts of the course's people that do not count.
std::size_t notCounted(const CourseProgress& progress);

/// A row for each of the person's attempts that count: task, start, result, passes in a row, why it failed.
ReportTable courseAttempts(const CourseProgress& progress, const CoursePerson& person);
/// The uuids of its rows.
std::vector<std::string> courseAttemptIds(const CoursePerson& person);
/// Sentences on all that is missing, since when the person is behind, which attempts came early or do not count.
std::vector<std::string> personNotes(const CourseProgress& progress, const CoursePerson& person);

/// Everybody, who is behind first, then what is missing.
ReportDocument courseDocument(const CourseProgress& progress);

}  // namespace calot::analytics

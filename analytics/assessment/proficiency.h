// SPDX-License-Identifier: GPL-3.0-or-later
// Proficiency in the tasks of a course: passes in a row, the retention test, and what a person still lacks. Attempts
// are judged already; no database, no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analytics/assessment/course.h"

namespace calot::analytics {

/// The effect of an attempt on its task's criterion.
enum class AttemptEffect : std::uint8_t {
  counted,     ///< a pass that counts
  tooSoon,     ///< a pass that comes fewer days than Course::daysBetween after the one before: the run stays as it is
  failed,      ///< the run begins again
  proficient,  ///< the pass that completes the run
  practice,    ///< after proficiency; no retention test, or not yet
  retained,    ///< the retention test, passed
  lapsed,      ///< the retention test, failed: a whole run is wanted again
};
std::string nameOf(AttemptEffect effect);  ///< "counted", "too soon", "failed", "proficient" ...

/// An attempt at a task, held against the task's norm.
struct CourseAttempt {
  std::string uuid;
  std::string startUtc;
  bool passed = false;
  std::string failure = {};  ///< "cystic duct left open, 1:40.2"; empty where it passed
  AttemptEffect effect = AttemptEffect::counted;
  std::uint32_t run = 0;  ///< passes in a row up to it, after it
};

enum class TaskState : std::uint8_t { notBegun, practising, proficient, retentionDue, retained, lapsed };
std::string nameOf(TaskState state);  ///< "not begun", "practising", "proficient", "retention due" ...

/// True of proficient, retentionDue and retained.
bool isProficient(TaskState state);

/// How far a person is with a task.
struct TaskStanding {
  TaskState state = TaskState::notBegun;
  bool open = false;                    ///< the criteria of all earlier tasks were met once
  std::size_t early = 0;                ///< attempts before it was open; they count
  std::uint32_t run = 0;                ///< passes in a row that count
  std::string countsFrom;               ///< first day of a pass that counts; empty: any
  std::string firstProficientUtc;       ///< start of the attempt by which the criterion was first met; or empty
  std::string proficientUtc;            ///< the same since the last lapse
  std::string retentionDay;             ///< from which on an attempt is the retention test; empty: no test ahead
  std::string dueDay;                   ///< last day on which to become proficient; empty: none is known
  bool behind = false;                  ///< that day is over, and the person is not proficient
  std::string missing;                  ///< one sentence: what is missing; empty: nothing
  std::vector<CourseAttempt> attempts;  ///< by start
};

/// A person's standing in every task. Days are those of UTC.
/// @param attempts by task; those of a task without a criterion are counted and not judged
/// @param today "2026-01-31"
/// @pre starts are dates (recorder::isDate())
std::vector<TaskStanding> proficiency(const Course& course, std::vector<std::vector<CourseAttempt>> attempts,
                                      const std::string& today);

}  // namespace calot::analytics

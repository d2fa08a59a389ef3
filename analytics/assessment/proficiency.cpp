// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/proficiency.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "recorder/base/dates.h"

namespace calot::analytics {
namespace {

std::string dayOf(const std::string& utc) { return utc.substr(0, 10); }

/// @param utc a date, whose time of the day does not count
std::string laterDay(const std::string& utc, std::uint32_t days) {
  return dayOf(recorder::shiftedDate(dayOf(utc) + "T00:00:00Z", std::int64_t{86400} * days));
}

/// Moves the standing on by one attempt.
AttemptEffect take(TaskStanding& standing, const CourseAttempt& attempt, const CourseCriterion& criterion,
                   std::uint32_t daysBetween) {
  const std::string day = dayOf(attempt.startUtc);
  if (standing.state == TaskState::retained) return AttemptEffect::practice;
  if (standing.state == TaskState::proficient) {
    if (standing.retentionDay.empty() || day < standing.retentionDay) return AttemptEffect::practice;
    standing.retentionDay.clear();
    standing.state = attempt.passed ? TaskState::retained : TaskState::lapsed;
    if (attempt.passed) return AttemptEffect::retained;
    standing.run = 0;
    standing.proficientUtc.clear();
    return AttemptEffect::lapsed;
  }
  if (standing.state == TaskState::notBegun) standing.state = TaskState::practising;
  if (attempt.passed && day < standing.countsFrom) return AttemptEffect::tooSoon;
  standing.countsFrom.clear();
  if (!attempt.passed) {
    standing.run = 0;
    return AttemptEffect::failed;
  }
  if (++standing.run < criterion.passes) {
    if (daysBetween > 0) standing.countsFrom = laterDay(attempt.startUtc, daysBetween);
    return AttemptEffect::counted;
  }
  standing.state = TaskState::proficient;
  standing.proficientUtc = attempt.startUtc;
  if (standing.firstProficientUtc.empty()) standing.firstProficientUtc = attempt.startUtc;
  if (criterion.retentionDays > 0) standing.retentionDay = laterDay(attempt.startUtc, criterion.retentionDays);
  return AttemptEffect::proficient;
}

/// @param waitsFor title of the first earlier task whose criterion is not met; or empty
std::string missingOf(const CourseTask& task, const TaskStanding& standing, const std::string& waitsFor) {
  if (standing.state == TaskState::retentionDue)
    return fmt::format("{}: the retention test is due since {}", task.title, standing.retentionDay);
  if (isProficient(standing.state)) return {};
  const CourseCriterion& criterion = *task.criterion;
  std::string text =
      fmt::format("{}: {}{} of {}", task.title, standing.state == TaskState::lapsed ? "lapsed, " : "", standing.run,
                  criterion.passes == 1 ? "1 pass" : fmt::format("{} passes in a row", criterion.passes));
  if (!waitsFor.empty()) text += fmt::format("; not open before {}", waitsFor);
  if (standing.attempts.empty()) return text + "; no attempt counts yet";
  const CourseAttempt& last = standing.attempts.back();
  if (last.effect == AttemptEffect::failed) text += "; the last failed: " + last.failure;
  if (last.effect == AttemptEffect::lapsed) text += "; the retention test failed: " + last.failure;
  if (!standing.countsFrom.empty()) text += "; the next pass counts from " + standing.countsFrom;
  return text;
}

/// The day from which due days count; empty while the course has not begun for this person.
std::string beginOf(const Course& course, const std::vector<TaskStanding>& standings) {
  std::string begin = course.begins;
  if (!begin.empty()) return begin;
  for (const TaskStanding& standing : standings) {
    if (standing.attempts.empty()) continue;
    const std::string first = dayOf(standing.attempts.front().startUtc);
    if (begin.empty() || first < begin) begin = first;
  }
  return begin;
}

}  // namespace

std::string nameOf(AttemptEffect effect) {
  constexpr const char* names[]{"counted", "too soon", "failed", "proficient", "practice", "retained", "lapsed"};
  return names[static_cast<std::size_t>(effect)];
}

std::string nameOf(TaskState state) {
  constexpr const char* names[]{"not begun", "practising", "proficient", "retention due", "retained", "lapsed"};
  return names[static_cast<std::size_t>(state)];
}

bool isProficient(TaskState state) {
  return state == TaskState::proficient || state == TaskState::retentionDue || state == TaskState::retained;
}

std::vector<TaskStanding> proficiency(const Course& course, std::vector<std::vector<CourseAttempt>> attempts,
                                      const std::string& today) {
  std::vector<TaskStanding> standings(course.tasks.size());
  for (std::size_t t = 0; t < standings.size(); ++t) {
    standings[t].attempts = std::move(attempts[t]);
    std::sort(standings[t].attempts.begin(), standings[t].attempts.end(),
              [](const CourseAttempt& a, const CourseAttempt& b) {
                return std::tie(a.startUtc, a.uuid) < std::tie(b.startUtc, b.uuid);
              });
  }
  const std::string begin = beginOf(course, standings);
  std::string openedUtc, waitsFor;  // by the attempt that met the criterion of the task before; the first unmet one
  for (std::size_t t = 0; t < standings.size(); ++t) {
    const CourseTask& task = course.tasks[t];
    TaskStanding& standing = standings[t];
    standing.open = waitsFor.empty();
    standing.early = static_cast<std::size_t>(
        std::count_if(standing.attempts.begin(), standing.attempts.end(),
                      [&](const CourseAttempt& a) { return !standing.open || a.startUtc < openedUtc; }));
    if (!task.criterion) {
      if (!standing.attempts.empty()) standing.state = TaskState::practising;
      continue;
    }
    for (CourseAttempt& attempt : standing.attempts) {
      attempt.effect = take(standing, attempt, *task.criterion, course.daysBetween);
      attempt.run = standing.run;
    }
    if (standing.state == TaskState::proficient && !standing.retentionDay.empty() && today >= standing.retentionDay)
      standing.state = TaskState::retentionDue;
    if (task.criterion->dueDays > 0 && !begin.empty()) {
      standing.dueDay = laterDay(begin, task.criterion->dueDays);
      standing.behind = today > standing.dueDay && !isProficient(standing.state);
    }
    standing.missing = missingOf(task, standing, waitsFor);
    openedUtc = std::max(openedUtc, standing.firstProficientUtc);
    if (waitsFor.empty() && standing.firstProficientUtc.empty()) waitsFor = task.title;
  }
  return standings;
}

}  // namespace calot::analytics

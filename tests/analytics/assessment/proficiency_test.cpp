// SPDX-License-Identifier: GPL-3.0-or-later
// Proficiency by tables of passes and failures with their days: "1- 2+ 9+" failed on the first day, passed on the
// second and on the ninth.
#include "analytics/assessment/proficiency.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <chrono>
#include <random>
#include <sstream>

#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Effect = AttemptEffect;

std::string day(int number) {
  const std::chrono::year_month_day date(std::chrono::sys_days(std::chrono::year(2026) / 1 / 1) +
                                         std::chrono::days(number - 1));
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

std::vector<CourseAttempt> tries(const std::string& text) {
  std::istringstream in(text);
  std::vector<CourseAttempt> attempts;
  for (std::string word; in >> word;) {
    const bool passed = word.back() == '+';
    word.pop_back();
    attempts.push_back({fmt::format("u{:03}", attempts.size()),
                        fmt::format("{}T09:{:02}:00Z", day(std::stoi(word)), attempts.size()), passed,
                        passed ? "" : "cystic duct left open"});
  }
  return attempts;
}

Course courseOf(const std::vector<CourseCriterion>& criteria) {
  Course course;
  for (const CourseCriterion& criterion : criteria)
    course.tasks.push_back({fmt::format("scene-{}", course.tasks.size() + 1),
                            fmt::format("Task {}", course.tasks.size() + 1), "Do.", criterion});
  return course;
}

CourseCriterion passes(std::uint32_t count) { return {"clinic", 0, count, 0, 0}; }

/// The standing in a course of one task.
TaskStanding after(const std::string& text, const CourseCriterion& criterion, int today = 400,
                   std::uint32_t daysBetween = 0) {
  Course course = courseOf({criterion});
  course.daysBetween = daysBetween;
  return proficiency(course, {tries(text)}, day(today))[0];
}

std::vector<Effect> effects(const TaskStanding& standing) {
  std::vector<Effect> all;
  for (const CourseAttempt& a : standing.attempts) all.push_back(a.effect);
  return all;
}

TEST(Proficiency, IsReachedAtTheThirdTry) {
  const TaskStanding standing = after("1- 2+ 3+", passes(2));
  EXPECT_EQ(standing.state, TaskState::proficient);
  EXPECT_EQ(standing.proficientUtc, standing.attempts[2].startUtc);
  EXPECT_EQ(standing.firstProficientUtc, standing.proficientUtc);
  EXPECT_EQ(effects(standing), (std::vector{Effect::failed, Effect::counted, Effect::proficient}));
  EXPECT_EQ(standing.missing, "");
}

TEST(Proficiency, IsANumberOfPassesInARow) {
  struct Case {
    const char* tries;
    std::uint32_t passes;
    TaskState state;
    std::uint32_t run;
  };
  const std::vector<Case> cases{
      {"", 2, TaskState::notBegun, 0},
      {"1-", 2, TaskState::practising, 0},
      {"1+", 2, TaskState::practising, 1},
      {"1+", 1, TaskState::proficient, 1},
      {"1+ 2-", 2, TaskState::practising, 0},
      {"1+ 2- 3+", 2, TaskState::practising, 1},
      {"1+ 2- 3+ 4+", 2, TaskState::proficient, 2},
      {"1+ 1+", 2, TaskState::proficient, 2},
      {"1+ 2+ 3- 4- 5-", 2, TaskState::proficient, 2},
      {"1+ 2+ 3- 4+ 5+", 3, TaskState::practising, 2},
  };
  for (const Case& c : cases) {
    const TaskStanding standing = after(c.tries, passes(c.passes));
    EXPECT_EQ(standing.state, c.state) << c.tries;
    EXPECT_EQ(standing.run, c.run) << c.tries;
    EXPECT_EQ(standing.missing.empty(), isProficient(c.state)) << c.tries;
  }
}

TEST(Proficiency, WhatIsMissingNamesTheRunAndTheLastFailure) {
  expectNames(after("1+ 2-", passes(2)).missing, {"Task 1", "0", "2", "cystic duct left open"});
  const std::string one = after("1- 2+", passes(3)).missing;
  expectNames(one, {"Task 1", "1", "3"});
  EXPECT_FALSE(holdsToken(one, "cystic")) << "a pass came after it";
}

TEST(Proficiency, AttemptsCountInTheOrderOfTheirStarts) {
  std::vector<CourseAttempt> attempts = tries("1- 2+ 3+");
  std::swap(attempts[0], attempts[2]);
  const TaskStanding standing = proficiency(courseOf({passes(2)}), {attempts}, day(9))[0];
  EXPECT_EQ(standing.state, TaskState::proficient);
  EXPECT_EQ(standing.attempts[0].startUtc.substr(0, 10), day(1));
}

/// Against a search for a run of passes in the text.
TEST(Proficiency, AgreesWithASearchForARun) {
  std::mt19937 generator(7);
  for (int round = 0; round < 400; ++round) {
    const auto needed = static_cast<std::uint32_t>(1 + generator() % 4);
    std::string marks, text;
    for (std::size_t i = 0, length = generator() % 12; i < length; ++i) {
      marks += generator() % 3 == 0 ? '-' : '+';
      text += fmt::format("{}{} ", i + 1, marks.back());
    }
    const std::size_t found = marks.find(std::string(needed, '+'));
    const TaskStanding standing = after(text, passes(needed));
    EXPECT_EQ(isProficient(standing.state), found != std::string::npos) << marks << " " << needed;
    if (found == std::string::npos) {
      EXPECT_EQ(standing.run, marks.size() - (marks.rfind('-') + 1)) << marks;
    } else {
      EXPECT_EQ(standing.proficientUtc.substr(0, 10), day(static_cast<int>(found + needed))) << marks;
    }
  }
}

TEST(Proficiency, PassesThatComeTooSoonNeitherCountNorHarm) {
  const TaskStanding waiting = after("1+ 2+ 7+", passes(2), 400, 7);
  EXPECT_EQ(effects(waiting), (std::vector{Effect::counted, Effect::tooSoon, Effect::tooSoon}));
  EXPECT_EQ(waiting.countsFrom, day(8));
  expectNames(waiting.missing, {"1", "2", day(8)});
  const TaskStanding standing = after("1+ 2+ 8+", passes(2), 400, 7);
  EXPECT_EQ(effects(standing), (std::vector{Effect::counted, Effect::tooSoon, Effect::proficient}));
  EXPECT_EQ(standing.countsFrom, "");
  // A failure ends the run, and with it the wait.
  EXPECT_EQ(effects(after("1+ 2- 3+ 4+ 10+", passes(2), 400, 7)),
            (std::vector{Effect::counted, Effect::failed, Effect::counted, Effect::tooSoon, Effect::proficient}));
  // The wait is from the pass that counted, not from the one that came too soon.
  EXPECT_EQ(after("1+ 7+ 8+", passes(2), 400, 7).state, TaskState::proficient);
}

TEST(Proficiency, DaysAreThoseOfTheCalendar) {
  Course course = courseOf({passes(2)});
  course.daysBetween = 1;
  const auto stateOf = [&](const std::string& first, const std::string& second) {
    return proficiency(course, {{{"a", first, true}, {"b", second, true}}}, day(9))[0].state;
  };
  EXPECT_EQ(stateOf("2026-01-01T23:59:00Z", "2026-01-02T00:01:00Z"), TaskState::proficient);
  EXPECT_EQ(stateOf("2026-01-01T00:01:00Z", "2026-01-01T23:59:00Z"), TaskState::practising);
}

TEST(Proficiency, IsRetainedOrLapsesByTheFirstAttemptAfterTheTime) {
  const CourseCriterion criterion{"clinic", 0, 2, 30, 0};
  struct Case {
    const char* tries;
    int today;
    TaskState state;
    std::uint32_t run;
    std::string retentionDay;
  };
  const std::vector<Case> cases{
      {"1+ 2+", 31, TaskState::proficient, 2, day(32)},
      {"1+ 2+", 32, TaskState::retentionDue, 2, day(32)},
      {"1+ 2+ 31-", 31, TaskState::proficient, 2, day(32)},
      {"1+ 2+ 31-", 40, TaskState::retentionDue, 2, day(32)},
      {"1+ 2+ 32+", 40, TaskState::retained, 2, ""},
      {"1+ 2+ 60+ 61-", 70, TaskState::retained, 2, ""},
      {"1+ 2+ 31- 32-", 40, TaskState::lapsed, 0, ""},
      {"1+ 2+ 40- 41+", 50, TaskState::lapsed, 1, ""},
      {"1+ 2+ 40- 41+ 42- 43+", 50, TaskState::lapsed, 1, ""},
      {"1+ 2+ 40- 41+ 42+", 50, TaskState::proficient, 2, day(72)},
      {"1+ 2+ 40- 41+ 42+ 72+", 80, TaskState::retained, 2, ""},
  };
  for (const Case& c : cases) {
    const TaskStanding standing = after(c.tries, criterion, c.today);
    EXPECT_EQ(standing.state, c.state) << c.tries;
    EXPECT_EQ(standing.run, c.run) << c.tries;
    EXPECT_EQ(standing.retentionDay, c.retentionDay) << c.tries;
    EXPECT_EQ(standing.firstProficientUtc.substr(0, 10), day(2)) << c.tries;
    EXPECT_EQ(standing.proficientUtc.empty(), c.state == TaskState::lapsed) << c.tries;
    EXPECT_EQ(standing.missing.empty(), c.state == TaskState::proficient || c.state == TaskState::retained) << c.tries;
  }
  expectNames(after("1+ 2+", criterion, 40).missing, {"Task 1", day(32)});
  expectNames(after("1+ 2+ 40-", criterion, 50).missing, {"0", "2", "cystic duct left open"});
  EXPECT_EQ(effects(after("1+ 2+ 3- 40- 41+ 42+ 72+ 73-", criterion, 80)),
            (std::vector{Effect::counted, Effect::proficient, Effect::practice, Effect::lapsed, Effect::counted,
                         Effect::proficient, Effect::retained, Effect::practice}));
}

TEST(Proficiency, TasksOpenInTheirOrderAndEarlyAttemptsCount) {
  Course course = courseOf({passes(1), passes(1), passes(1)});
  course.tasks[1].criterion.reset();
  std::vector<TaskStanding> s = proficiency(course, {{}, tries("1+"), tries("2+ 3+")}, day(9));
  EXPECT_TRUE(s[0].open);
  EXPECT_FALSE(s[1].open);
  EXPECT_FALSE(s[2].open);
  EXPECT_EQ(s[1].state, TaskState::practising) << "nothing judges it";
  EXPECT_EQ(s[2].state, TaskState::proficient);
  EXPECT_EQ(s[2].early, 2U);
  s = proficiency(course, {tries("3-"), {}, {}}, day(9));
  expectNames(s[2].missing, {"Task 3", "Task 1"});
  // A task without a criterion holds nobody back.
  s = proficiency(course, {tries("1- 2+"), {}, tries("1+ 4+")}, day(9));
  EXPECT_TRUE(s[1].open);
  EXPECT_TRUE(s[2].open);
  EXPECT_EQ(s[2].early, 1U);
}

TEST(Proficiency, ALapseClosesNoLaterTask) {
  const Course course = courseOf({{"clinic", 0, 1, 30, 0}, passes(1)});
  const std::vector<TaskStanding> s = proficiency(course, {tries("1+ 40-"), {}}, day(50));
  EXPECT_EQ(s[0].state, TaskState::lapsed);
  EXPECT_TRUE(s[1].open);
}

TEST(Proficiency, IsLateAfterTheDueDay) {
  Course course = courseOf({passes(1), {"clinic", 0, 1, 30, 10}});
  const auto second = [&](const std::string& first, const std::string& text, int today) {
    return proficiency(course, {tries(first), tries(text)}, day(today))[1];
  };
  EXPECT_EQ(second("", "", 400).dueDay, "") << "the course has not begun";
  EXPECT_EQ(second("5-", "", 15).dueDay, day(15)) << "with the first attempt at any task";
  EXPECT_FALSE(second("5-", "", 15).behind);
  EXPECT_TRUE(second("5-", "", 16).behind);
  EXPECT_TRUE(second("5-", "6-", 16).behind);
  EXPECT_FALSE(second("5-", "16+", 16).behind) << "late, and there";
  EXPECT_TRUE(second("5-", "6+ 40-", 50).behind) << "lapsed";
  EXPECT_FALSE(second("5-", "6+", 50).behind) << "a retention test that is due";
  course.begins = day(1);
  EXPECT_EQ(second("5-", "", 16).dueDay, day(11));
  EXPECT_FALSE(second("", "", 11).behind);
  EXPECT_TRUE(second("", "", 12).behind) << "who never came, too";
  EXPECT_FALSE(proficiency(course, {{}, {}}, day(99))[0].behind) << "no due day";
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/course_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "recorder/base/counted.h"

namespace calot::analytics {
namespace {

/// A sentence for each person whom it concerns. @param sinceOf words for a standing; empty: it does not concern it
void addWho(const CourseProgress& progress, const char* heading, std::string (*sinceOf)(const TaskStanding&),
            std::vector<std::string>& notes) {
  for (const CoursePerson& person : progress.people) {
    std::vector<std::string> tasks;
    for (std::size_t t = 0; t < person.tasks.size(); ++t) {
      if (const std::string since = sinceOf(person.tasks[t]); !since.empty())
        tasks.push_back(fmt::format("{} ({})", progress.course.tasks[t].title, since));
    }
    if (!tasks.empty())
      notes.push_back(fmt::format("{}: {}, {}.", heading, person.participant, fmt::join(tasks, ", ")));
  }
}

}  // namespace

std::string standingCell(const CourseTask& task, const TaskStanding& standing) {
  if (standing.state == TaskState::notBegun && !standing.behind) return "-";
  if (!task.criterion) return recorder::counted(standing.attempts.size(), "try", "tries");
  if (isProficient(standing.state)) return nameOf(standing.state);
  return fmt::format("{}{}/{}{}", standing.state == TaskState::lapsed ? "lapsed, " : "", standing.run,
                     task.criterion->passes, standing.behind ? ", behind" : "");
}

bool isBehind(const CoursePerson& person) { return std::ranges::any_of(person.tasks, &TaskStanding::behind); }

std::string proficientOf(const Course& course, const CoursePerson& person) {
  std::size_t reached = 0, of = 0;
  for (std::size_t t = 0; t < person.tasks.size(); ++t) {
    if (!course.tasks[t].criterion) continue;
    ++of;
    reached += isProficient(person.tasks[t].state) ? 1 : 0;
  }
  return of == 0 ? "-" : fmt::format("{} of {}", reached, of);
}

std::string nextMissing(const CoursePerson& person) {
  const auto next = std::ranges::find_if(person.tasks, [](const TaskStanding& s) { return !s.missing.empty(); });
  return next == person.tasks.end() ? "" : next->missing;
}

std::vector<const CoursePerson*> behindFirst(const CourseProgress& progress) {
  std::vector<const CoursePerson*> people;
  for (const CoursePerson& person : progress.people) people.push_back(&person);
  std::stable_partition(people.begin(), people.end(), [](const CoursePerson* person) { return isBehind(*person); });
  return people;
}

ReportTable courseTable(const CourseProgress& progress, const std::vector<const CoursePerson*>& people) {
  std::vector<std::string> columns{"=participant", "=group"};
  for (const CourseTask& task : progress.course.tasks) columns.push_back("=" + task.title);
  ReportTable table = tableOf("", columns);
  const bool alike =
      std::ranges::all_of(people, [&](const CoursePerson* p) { return p->group == people.front()->group; });
  for (const CoursePerson* person : people) {
    std::vector<std::string>& row =
        table.rows.emplace_back(std::vector{person->participant, alike ? std::string() : person->group});
    for (std::size_t t = 0; t < person->tasks.size(); ++t)
      row.push_back(standingCell(progress.course.tasks[t], person->tasks[t]));
  }
  return table;
}

std::vector<std::string> courseNotes(const CourseProgress& progress) {
  std::vector<std::string> notes;
  addWho(
      progress, "Behind", [](const TaskStanding& s) { return s.behind ? "due on " + s.dueDay : std::string(); }, notes);
  addWho(
      progress, "Retention test",
      [](const TaskStanding& s) {
        return s.state == TaskState::retentionDue ? "due since " + s.retentionDay : std::string();
      },
      notes);
  return notes;
}

std::size_t notCounted(const CourseProgress& progress) {
  std::size_t count = 0;
  for (const CoursePerson& person : progress.people) {
    for (const auto& reasons : person.uncounted) {
      for (const auto& entry : reasons) count += entry.second;
    }
  }
  return count;
}

ReportTable courseAttempts(const CourseProgress& progress, const CoursePerson& person) {
  ReportTable table = tableOf("", {"=task", "=start", "=result", "in a row", "=because"});
  for (std::size_t t = 0; t < person.tasks.size(); ++t) {
    const CourseTask& task = progress.course.tasks[t];
    for (const CourseAttempt& a : person.tasks[t].attempts) {
      const std::string result = !task.criterion ? "not judged" : (a.passed ? "passed" : "failed");
      const std::string effect = nameOf(a.effect);
      table.rows.push_back(
          {task.title, a.startUtc,
           !task.criterion || effect == "counted" || effect == result ? result : result + ", " + effect,
           task.criterion ? fmt::format("{}/{}", a.run, task.criterion->passes) : "", a.failure});
    }
  }
  return table;
}

std::vector<std::string> courseAttemptIds(const CoursePerson& person) {
  std::vector<std::string> uuids;
  for (const TaskStanding& standing : person.tasks) {
    for (const CourseAttempt& a : standing.attempts) uuids.push_back(a.uuid);
  }
  return uuids;
}

std::vector<std::string> personNotes(const CourseProgress& progress, const CoursePerson& person) {
  std::vector<std::string> notes;
  if (nextMissing(person).empty()) notes.emplace_back("Nothing is missing.");
  for (std::size_t t = 0; t < person.tasks.size(); ++t) {
    const std::string& title = progress.course.tasks[t].title;
    const TaskStanding& s = person.tasks[t];
    if (!s.missing.empty()) notes.push_back(s.missing + ".");
    if (s.behind) notes.push_back(fmt::format("{}: behind, due on {}.", title, s.dueDay));
    if (s.early > 0)
      notes.push_back(fmt::format("{}: {} before the task was open; {}.", title, recorder::counted(s.early, "attempt"),
                                  s.early == 1 ? "it counts" : "they count"));
    for (const auto& [reason, count] : person.uncounted[t])
      notes.push_back(fmt::format("{}: {} not counted: {}.", title, recorder::counted(count, "attempt"), reason));
  }
  return notes;
}

ReportDocument courseDocument(const CourseProgress& progress) {
  ReportDocument document{progress.course.title, progress.synthetic, {}};
  document.add(fmt::format("{} on {}.", recorder::counted(progress.people.size(), "participant"), progress.today));
  const std::vector<const CoursePerson*> people = behindFirst(progress);
  ReportTable table = courseTable(progress, people);
  table.columns.insert(table.columns.begin() + 2, {"proficient", Align::left});
  for (std::size_t i = 0; i < people.size(); ++i)
    table.rows[i].insert(table.rows[i].begin() + 2, proficientOf(progress.course, *people[i]));
  dropEmptyColumns(table);
  document.parts.emplace_back(std::move(table));
  document.addList(courseNotes(progress));
  document.parts.emplace_back(Heading{"What is missing"});
  std::vector<std::string> missing;
  for (const CoursePerson* person : people) {
    if (const std::string next = nextMissing(*person); !next.empty())
      missing.push_back(fmt::format("{}: {}.", person->participant, next));
  }
  if (missing.empty())
    document.add("Nothing is missing.");
  else
    document.addList(missing);
  return document;
}

}  // namespace calot::analytics

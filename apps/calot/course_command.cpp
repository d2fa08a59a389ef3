// SPDX-License-Identifier: GPL-3.0-or-later
// calot course: how far everybody is in a course, who is behind, and what a trainee still lacks.
#include <set>

#include "analytics/assessment/course_progress.h"
#include "analytics/report/course_tables.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "recorder/base/counted.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

using analytics::CoursePerson;
using analytics::CourseProgress;
using analytics::CourseTask;
using analytics::TaskStanding;

struct CourseOptions {
  std::string database, course, participant, group;
  bool includeSynthetic = false, json = false;
};

Json textOrNull(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json tasksJson(const CourseProgress& progress) {
  Json tasks = Json::array();
  for (std::size_t t = 0; t < progress.norms.size(); ++t) {
    const CourseTask& task = progress.course.tasks[t];
    Json& row = tasks.emplace_back(Json{{"scene", task.scene}, {"title", task.title}, {"criterion", nullptr}});
    if (!task.criterion) continue;
    row["criterion"] = {{"norm", progress.norms[t]->name},
                        {"norm_version", progress.norms[t]->version},
                        {"comparability_key", progress.norms[t]->comparabilityKey},
                        {"passes", task.criterion->passes},
                        {"retention_days", task.criterion->retentionDays},
                        {"due_days", task.criterion->dueDays}};
  }
  return tasks;
}

Json standingJson(const CourseTask& task, const TaskStanding& s, const std::map<std::string, std::size_t>& uncounted) {
  Json attempts = Json::array(), notCounted = Json::array();
  for (const analytics::CourseAttempt& a : s.attempts) {
    Json& row = attempts.emplace_back(Json{{"attempt", a.uuid}, {"start_utc", a.startUtc}});
    if (!task.criterion) continue;
    row.update({{"passed", a.passed},
                {"failure", textOrNull(a.failure)},
                {"effect", nameOf(a.effect)},
                {"passes_in_row", a.run}});
  }
  for (const auto& [reason, count] : uncounted) notCounted.push_back({{"reason", reason}, {"attempts", count}});
  return {{"scene", task.scene},
          {"state", nameOf(s.state)},
          {"open", s.open},
          {"tries", s.attempts.size()},
          {"early_tries", s.early},
          {"passes_in_row", s.run},
          {"proficient_utc", textOrNull(s.proficientUtc)},
          {"next_pass_day", textOrNull(s.countsFrom)},
          {"retention_day", textOrNull(s.retentionDay)},
          {"due_day", textOrNull(s.dueDay)},
          {"behind", s.behind},
          {"missing", textOrNull(s.missing)},
          {"attempts", attempts},
          {"not_counted", notCounted}};
}

Json progressJson(const CourseProgress& progress) {
  Json people = Json::array();
  for (const CoursePerson& person : progress.people) {
    Json tasks = Json::array();
    for (std::size_t t = 0; t < person.tasks.size(); ++t)
      tasks.push_back(standingJson(progress.course.tasks[t], person.tasks[t], person.uncounted[t]));
    people.push_back({{"participant", person.participant},
                      {"group", person.group},
                      {"behind", analytics::isBehind(person)},
                      {"tasks", tasks}});
  }
  return {{"course", progress.course.name},  {"title", progress.course.title}, {"day", progress.today},
          {"synthetic", progress.synthetic}, {"tasks", tasksJson(progress)},   {"participants", people}};
}

void printNotes(const std::vector<std::string>& notes, std::ostream& out) {
  for (const std::string& note : notes) out << wrappedText(note, terminalColumns(), 2) << '\n';
}

void printEverybody(const CourseProgress& progress, std::ostream& out) {
  std::vector<const CoursePerson*> people;
  for (const CoursePerson& person : progress.people) people.push_back(&person);
  if (!people.empty()) analytics::courseTable(progress, people).print(out, terminalColumns());
  printNotes(analytics::courseNotes(progress), out);
  if (const std::size_t uncounted = analytics::notCounted(progress); uncounted > 0)
    out << fmt::format("{} not counted; --participant gives the reasons\n", recorder::counted(uncounted, "attempt"));
}

/// The attempts of one person, and what is missing.
void printPerson(const CourseProgress& progress, const CoursePerson& person, std::ostream& out) {
  if (const analytics::ReportTable table = analytics::courseAttempts(progress, person); !table.rows.empty()) {
    table.print(out, terminalColumns());
    out << '\n';
  }
  printNotes(analytics::personNotes(progress, person), out);
}

/// Leaves those that the options name. @throws Error (refused) where nobody is left
void choose(CourseProgress& progress, const CourseOptions& o) {
  std::set<std::string> groups;
  for (const CoursePerson& person : progress.people) groups.insert(person.group);
  std::erase_if(progress.people, [&](const CoursePerson& person) {
    return (!o.group.empty() && person.group != o.group) ||
           (!o.participant.empty() && person.participant != o.participant);
  });
  if (!progress.people.empty() || (o.group.empty() && o.participant.empty())) return;
  if (!o.participant.empty())
    throw Error(ErrorKind::refused, Where{o.database},
                fmt::format("the course is not assigned to a participant \"{}\"{}", recorder::shown(o.participant),
                            o.group.empty() ? "" : fmt::format(" of group \"{}\"", recorder::shown(o.group))));
  groups.erase("");
  throw Error(
      ErrorKind::refused, Where{o.database},
      fmt::format("the course is not assigned to a group \"{}\"; {}", recorder::shown(o.group),
                  groups.empty() ? "nobody has a group" : fmt::format("there are {}", fmt::join(groups, ", "))));
}

void showCourse(const CourseOptions& o) {
  Progress progressLine("Reading the course's attempts", o.json);
  const std::filesystem::path file = findAsset(o.course, "curricula", "course");
  const analytics::Course course = analytics::readCourse(file);
  analytics::refuseUnsound(o.database);
  const analytics::CohortDatabase cohort(o.database, analytics::CohortDatabase::Access::read);
  CourseProgress progress = analytics::courseProgress(cohort, course, file.string(),
                                                      recorder::presentDate().substr(0, 10), o.includeSynthetic);
  choose(progress, o);
  printResult(o.json, "course-progress", progressJson(progress), [&](std::ostream& out) {
    if (progress.synthetic) out << analytics::watermarkText << '\n';
    if (o.participant.empty()) {
      printEverybody(progress, out);
    } else {
      printPerson(progress, progress.people.front(), out);
    }
    out << fmt::format("{}: {}\n", course.name, recorder::counted(progress.people.size(), "participant"));
  });
}

}  // namespace

void addCourse(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"course", "Show who is proficient in a course's tasks, and who is behind",
                  "calot course c.db --course course.json", "calot course c.db --course course.json --participant P1"},
                 showCourse);
  addCohortOption(*command, o->database)->required();
  command->add_option("--course", o->course, "A course, a file or the name of one that comes with the program")
      ->required();
  command->add_option("--participant", o->participant, "This one's attempts, and what is missing")
      ->transform(CLI::Validator(pseudonymForm, ""));
  command->add_option("--group", o->group, "Only this group's participants");
  command->add_flag("--include-synthetic", o->includeSynthetic, "Take in what performers made (watermarked)");
  command->add_flag("--json", o->json, "Print JSON");
}

}  // namespace calot::apps

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/course.h"

#include <set>

#include "analytics/assessment/declared_document.h"
#include "recorder/base/dates.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"

namespace calot::analytics {
namespace {

constexpr double longestDays = 3650;  // ten years

}  // namespace

std::vector<Field> CourseCriterion::fields() {
  using S = CourseCriterion;
  return {
      object("criterion", "Criterion of proficiency in a task: a norm that is passed several times in a row"),
      {"norm", at<S, &S::norm>, plainName, "Name of a norm of the cohort, made on the task's scene"},
      optional("normVersion", at<S, &S::normVersion>, "", within(0, 1000000), "Its version; 0: the newest"),
      optional("passes", at<S, &S::passes>, "", within(1, 20), "Passes in a row"),
      optional("retentionDays", at<S, &S::retentionDays>, "", within(0, longestDays),
               "Days from proficiency to the retention test; 0: there is no test"),
      optional("dueDays", at<S, &S::dueDays>, "", within(0, longestDays),
               "Days from the begin of the course in which to become proficient; 0: no limit"),
  };
}

std::vector<Field> CourseTask::fields() {
  using S = CourseTask;
  return {
      object("task", "Task on a scene"),
      {"scene", at<S, &S::scene>, TextRule{60}, "Name of a scene (calot scenes)"},
      {"title", at<S, &S::title>, TextRule{80}, "A word or a few: Clip and cut"},
      {"goal", at<S, &S::goal>, TextRule{300}, "One sentence: what is to be reached"},
      optional("criterion", at<S, &S::criterion>,
               "Criterion of proficiency. The next task is open when it is met; a task without one holds nobody back"),
  };
}

std::vector<Field> Course::fields() {
  using S = Course;
  return {
      object("", "Tasks of rising difficulty, and the criterion of proficiency in each"),
      fileFormat("calot-course"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, TextRule{60}, "Name of the course"},
      {"title", at<S, &S::title>, TextRule{80}, "One line"},
      optional("groups", at<S, &S::groups>, anyName,
               "Groups of participants to whom the course is assigned; everybody if absent")
          .items(1, 50),
      optional("begins", at<S, &S::begins>,
               TextRule{10, "^[0-9]{4}-[0-9]{2}-[0-9]{2}$", "a day as 2026-01-31 is expected"},
               "Day from which due days count; a person's first attempt at one of the tasks if absent"),
      optional("daysBetween", at<S, &S::daysBetween>, "", within(0, longestDays),
               "Fewest days from a pass to the next that counts, by the calendar in UTC; 1: on another day"),
      Field("tasks", at<S, &S::tasks>, "The easiest first; no scene twice").items(1, 50),
  };
}

Course readCourse(const std::filesystem::path& file) {
  const nlohmann::json json =
      recorder::parseStrictJson(recorder::readFileBytes(file, file.string(), 1U << 16U), file.string());
  const recorder::JsonPlace root(json, file.string());
  Course course;
  recorder::readRecord(root, course);
  if (!course.begins.empty() && !recorder::isDate(course.begins + "T00:00:00Z"))
    root.at("begins").fail("there is no such day");
  std::set<std::string> seen;
  for (std::size_t i = 0; i < course.groups.size(); ++i) {
    if (!seen.insert(course.groups[i]).second) root.at("groups").at(i).fail("an earlier group is the same");
  }
  seen.clear();
  for (std::size_t i = 0; i < course.tasks.size(); ++i) {
    if (!seen.insert(course.tasks[i].scene).second)
      root.at("tasks").at(i).at("scene").fail("an earlier task has this scene");
  }
  return course;
}

}  // namespace calot::analytics

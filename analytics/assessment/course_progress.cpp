// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/course_progress.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "analytics/assessment/grade.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/report_document.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using ValuesOfAttempts = std::map<std::string, std::vector<AttemptValue>>;

Norm normOf(const CohortDatabase& cohort, const CourseTask& task, const Where& where) {
  std::optional<Norm> norm;
  try {
    norm = cohort.norm(task.criterion->norm, task.criterion->normVersion);
  } catch (const Error& error) {
    throw Error(error.kind(), where, error.what());
  }
  const std::string scene = norm->comparabilityKey.substr(0, norm->comparabilityKey.find('/'));
  if (scene != task.scene)
    throw Error(ErrorKind::refused, where,
                fmt::format("norm {} {} is of scene {}, the task is on {}", norm->name, norm->version, scene,
                            recorder::shown(task.scene)));
  return *std::move(norm);
}

/// Those to whom the course is assigned, by pseudonym.
std::vector<CoursePerson> assigned(const CohortDatabase& cohort, const Course& course, const std::string& file) {
  std::vector<CoursePerson> people;
  std::set<std::string> groups;
  for (const Participant& p : cohort.participants()) {
    if (!p.group.empty()) groups.insert(p.group);
    if (course.groups.empty() || std::find(course.groups.begin(), course.groups.end(), p.group) != course.groups.end())
      people.push_back({p.pseudonym, p.group, {}, {}});
  }
  for (std::size_t i = 0; i < course.groups.size(); ++i) {
    if (groups.count(course.groups[i]) == 0)
      throw Error(
          ErrorKind::refused, Where{file, fmt::format("/groups/{}", i)},
          fmt::format("{}: no participant is of group \"{}\"; {}", cohort.path(), recorder::shown(course.groups[i]),
                      groups.empty() ? "none has a group" : fmt::format("there are {}", fmt::join(groups, ", "))));
  }
  return people;
}

/// The reason why an attempt on a task's scene does not count; or empty. @param norm null: there is no criterion
std::string whyNotCounted(const AttemptRow& attempt, const Norm* norm, bool includeSynthetic) {
  constexpr std::array<std::string_view, 4> waived{"withdrawn", "consent", "practice", "group"};  // rules of studies
  for (const LeftOut& out : attempt.leftOut) {
    const bool lifted = std::find(waived.begin(), waived.end(), out.rule) != waived.end();
    if (!lifted && !(out.rule == "synthetic" && includeSynthetic)) return out.reason;
  }
  if (!recorder::isDate(attempt.startUtc)) return "start not known";
  if (norm != nullptr && attempt.comparabilityKey != norm->comparabilityKey)
    return "not comparable with the norm: " + comparabilityWords(attempt.comparabilityKey);
  return {};
}

/// A figure of the rule that was not passed: "path-length left 82.1 mm, at most 61.7".
std::string failedFigure(const GradedFigure& f) {
  const std::string name = figureName(f.mark.checkpoint, f.mark.subject);
  if (!f.value || !f.mark.cut) return fmt::format("{}: {}", name, f.missing);
  const auto number = [&](double si) { return figureNumber(findCheckpoint(f.mark.checkpoint), si * f.displayFactor); };
  return fmt::format("{} {}{}, {} {}", name, number(*f.value), f.unit == "1" ? "" : " " + f.unit,
                     f.mark.direction == Direction::lower ? "at most" : "at least", number(*f.mark.cut));
}

/// @pre the attempt did not pass
std::string failureOf(const Grade& grade) {
  if (grade.criticalErrors.value_or(0.0) > 0.0) {
    const std::string& note = grade.criticalNote;  // behind the errors: what is not assessed, as wordsOf() writes it
    return note.empty() ? "a critical error" : note.substr(0, note.find("; not assessed: "));
  }
  if (grade.attempt.outcome != recorder::Outcome::completed)
    return fmt::format("not completed ({})", recorder::wordFor(grade.attempt.outcome));
  std::vector<std::string> figures;
  for (const GradedFigure& f : grade.figures) {
    if (f.mark.inRule && !f.passed.value_or(false)) figures.push_back(failedFigure(f));
  }
  return fmt::format("{}", fmt::join(figures, "; "));
}

CourseAttempt judged(const AttemptRow& attempt, const Norm* norm, const ValuesOfAttempts& values,
                     const std::string& name) {
  CourseAttempt result{attempt.uuid, attempt.startUtc};
  if (norm == nullptr) return result;
  const auto own = values.find(attempt.uuid);
  // Alone: history and errors of measurement, which need the others, do not change what passes.
  const Grade grade = gradeAttempt(attempt, {attempt}, own == values.end() ? std::vector<AttemptValue>{} : own->second,
                                   *norm, false, name);
  result.passed = grade.passed && attempt.outcome == recorder::Outcome::completed;
  if (!result.passed) result.failure = failureOf(grade);
  return result;
}

}  // namespace

CourseProgress courseProgress(const CohortDatabase& cohort, const Course& course, const std::string& file,
                              const std::string& today, bool includeSynthetic) {
  CourseProgress progress{course, today, {}, assigned(cohort, course, file), false};
  for (std::size_t t = 0; t < course.tasks.size(); ++t) {
    std::optional<Norm>& norm = progress.norms.emplace_back();
    if (!course.tasks[t].criterion) continue;
    norm = normOf(cohort, course.tasks[t], Where{file, fmt::format("/tasks/{}/criterion/norm", t)});
    progress.synthetic = progress.synthetic || norm->synthetic;
  }
  ValuesOfAttempts values;
  for (AttemptValue& v : cohort.allValues()) values[v.attempt].push_back(std::move(v));
  const std::vector<AttemptRow> attempts = cohort.listAttempts();
  std::map<std::string, std::vector<const AttemptRow*>> attemptsOf;
  for (const AttemptRow& a : attempts) attemptsOf[a.participant].push_back(&a);
  for (CoursePerson& person : progress.people) {
    person.uncounted.resize(course.tasks.size());
    std::vector<std::vector<CourseAttempt>> counted(course.tasks.size());
    for (const AttemptRow* a : attemptsOf[person.participant]) {
      const auto task = std::find_if(course.tasks.begin(), course.tasks.end(),
                                     [&](const CourseTask& of) { return of.scene == a->scene; });
      if (task == course.tasks.end()) continue;
      const auto t = static_cast<std::size_t>(task - course.tasks.begin());
      const Norm* const norm = progress.norms[t] ? &*progress.norms[t] : nullptr;
      if (const std::string why = whyNotCounted(*a, norm, includeSynthetic); !why.empty()) {
        ++person.uncounted[t][why];
        continue;
      }
      counted[t].push_back(judged(*a, norm, values, cohort.path()));
      progress.synthetic = progress.synthetic || a->synthetic;
    }
    person.tasks = proficiency(course, std::move(counted), today);
  }
  return progress;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// A course over a cohort: which attempts count, what fails them, to whom the course is assigned, and what is refused.
#include "analytics/assessment/course_progress.h"

#include <gtest/gtest.h>

#include "analytics/assessment/norm.h"
#include "analytics/checkpoints/error_words.h"
#include "analytics/cohort/withdraw.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using support::humanAttempt;
using support::uuidOf;

/// A norm of experts around 50 s and novices around 90 s, and a course of one task that wants two passes in a row.
class CourseCohort : public testing::Test {
 protected:
  CourseCohort() : path_(folder_.file("c.db")), cohort_(path_, CohortDatabase::Access::create) {
    for (unsigned i = 0; i < 6; ++i) {
      add(attempt(i, fmt::format("E{}", i)), "expert", 48.0 + i);
      add(attempt(10 + i, fmt::format("N{}", i)), "novice", 88.0 + i);
    }
    NormRequest request;
    request.name = "clinic";
    request.by = "A. Instructor";
    cohort_.storeNorm(makeNorm(cohort_.listAttempts(), cohort_.allValues(), {}, request, "c.db"));
    course_.name = "course";
    course_.groups = {"trainee"};
    course_.tasks = {{"touch-liver", "Touch", "Touch.", CourseCriterion{"clinic", 0, 2, 0, 0}}};
  }

  static AttemptRecord attempt(unsigned n, const std::string& who) {
    AttemptRecord a = humanAttempt(n, who);
    a.startUtc = fmt::format("2026-03-{:02}T09:{:02}:00Z", 1 + n / 60, n % 60);
    return a;
  }

  void add(const AttemptRecord& a, const std::string& group, double seconds, double errors = 0.0) {
    if (!support::findParticipant(cohort_, a.participant))
      cohort_.addParticipant({a.participant, group, "", "", {}, {}});
    CheckpointValue critical = makeValue(*findCheckpoint("critical-errors"), "", Origin::resimulated, errors);
    if (errors > 0.0)
      critical.note =
          wordsOf({{Severity::critical, 1, 100.2, "cystic duct left open"}}, Severity::critical, {"bleeding"}).lines;
    cohort_.storeAttempt(a, {makeValue(*findCheckpoint("elapsed-time"), "", Origin::resimulated, seconds), critical});
  }

  CourseProgress progress(bool includeSynthetic = false) {
    return courseProgress(cohort_, course_, "course.json", "2026-06-01", includeSynthetic);
  }
  /// The only person's only task.
  TaskStanding standing() { return progress().people.at(0).tasks.at(0); }

  support::Folder folder_;
  std::string path_;
  CohortDatabase cohort_;
  Course course_;
};

TEST_F(CourseCohort, aTraineePassesAtTheThirdTry) {
  add(attempt(60, "T1"), "trainee", 120.0);
  EXPECT_EQ(standing().state, TaskState::practising);
  expectNames(standing().missing, {"Touch", "0", "2", "elapsed-time", "120.0 s"});
  add(attempt(61, "T1"), "trainee", 50.0);
  expectNames(standing().missing, {"1", "2"});
  add(attempt(62, "T1"), "trainee", 50.0);
  const CourseProgress p = progress();
  ASSERT_EQ(p.people.size(), 1U) << "of the group alone";
  EXPECT_EQ(p.people[0].participant, "T1");
  EXPECT_EQ(p.norms[0]->version, 1U);
  EXPECT_FALSE(p.synthetic);
  EXPECT_EQ(standing().state, TaskState::proficient);
  EXPECT_EQ(standing().proficientUtc, attempt(62, "T1").startUtc);
}

TEST_F(CourseCohort, aCriticalErrorEndsTheRunWhateverTheFigures) {
  add(attempt(60, "T1"), "trainee", 50.0);
  add(attempt(61, "T1"), "trainee", 50.0, 1.0);
  EXPECT_EQ(standing().run, 0U);
  expectNames(standing().missing, {"cystic duct left open, 1:40.2"});
  EXPECT_FALSE(holdsToken(standing().missing, "bleeding")) << "which is not assessed";
}

TEST_F(CourseCohort, whoDoesNotCompleteTheTaskDoesNotPass) {
  add(attempt(60, "T1"), "trainee", 50.0);
  for (const recorder::Outcome outcome :
       {recorder::Outcome::timeLimit, recorder::Outcome::abandoned, recorder::Outcome::stopped}) {
    AttemptRecord a = attempt(61 + static_cast<unsigned>(outcome), "T1");
    a.outcome = outcome;
    add(a, "trainee", 50.0);
    EXPECT_EQ(standing().run, 0U);
    expectNames(standing().missing, {recorder::wordFor(outcome)});
  }
}

TEST_F(CourseCohort, attemptsThatProveNothingDoNotCount) {
  add(attempt(60, "T1"), "trainee", 50.0);
  const auto addOther = [&](unsigned n, auto change) {
    AttemptRecord a = attempt(n, "T1");
    change(a);
    add(a, "trainee", 120.0);
  };
  addOther(70, [](AttemptRecord& a) { a.verification.verdict = Verdict::diverged; });
  addOther(71, [](AttemptRecord& a) { a.verification.verdict = Verdict::notChecked; });
  addOther(72, [](AttemptRecord& a) { a.complete = false; });
  addOther(73, [](AttemptRecord& a) { a.outcome = recorder::Outcome::technicalFailure; });
  addOther(74, [](AttemptRecord& a) { a.parent = uuidOf(60); });
  addOther(75, [](AttemptRecord& a) { a.purpose = "golden"; });
  addOther(76, [](AttemptRecord& a) { a.comparabilityKey.replace(a.comparabilityKey.find("falcon"), 6, "mouse"); });
  addOther(77, [](AttemptRecord&) {});
  cohort_.excludeAttempts({uuidOf(77)}, "wrong person", "me");
  const CourseProgress p = progress();
  EXPECT_EQ(p.people[0].tasks[0].run, 1U) << "none of the others ended it";
  ASSERT_EQ(p.people[0].tasks[0].attempts.size(), 1U);
  std::size_t others = 0;
  std::vector<std::string> reasons;
  for (const auto& [reason, count] : p.people[0].uncounted[0]) {
    others += count;
    reasons.push_back(reason);
  }
  EXPECT_EQ(others, 8U);
  expectDistinct(reasons);
  EXPECT_EQ(reasons.size(), 8U);
  EXPECT_TRUE(std::any_of(reasons.begin(), reasons.end(), [](const std::string& r) { return holdsToken(r, "mouse"); }));
}

TEST_F(CourseCohort, practiceAndResearchDoNotDecideWhoIsTrained) {
  course_.groups = {"expert"};
  cohort_.setParticipant("N0", {{}, {}, {}, {}, {{"research", "2026-01-01"}}});  // the experts gave none
  AttemptRecord practised = attempt(60, "E0");
  practised.mode = recorder::Mode::practice;
  practised.purpose = "training";
  add(practised, "expert", 50.0);
  const CourseProgress p = progress();
  ASSERT_EQ(p.people.size(), 6U);
  for (const CoursePerson& person : p.people)
    EXPECT_EQ(person.tasks[0].run, person.participant == "E0" ? 2U : 1U) << person.participant;
  withdraw(path_, planWithdrawal(path_, "E0", WithdrawalScope::research));
  course_.groups.clear();  // a withdrawal takes the study group away
  const CoursePerson withdrawn = progress().people[0];
  EXPECT_EQ(withdrawn.participant, "E0");
  ASSERT_EQ(withdrawn.tasks[0].attempts.size(), 1U) << "the one of a study is gone";
  EXPECT_EQ(withdrawn.tasks[0].attempts[0].uuid, practised.uuid);
}

TEST_F(CourseCohort, performersCountOnlyWhereTheyAreAskedFor) {
  AttemptRecord a = attempt(60, "T1");
  a.synthetic = true;
  a.operatorKind = recorder::OperatorKind::performer;
  a.profile = "skilled";
  a.profileVersion = "1";
  add(a, "trainee", 50.0);
  EXPECT_TRUE(standing().attempts.empty());
  EXPECT_FALSE(progress().synthetic);
  EXPECT_EQ(progress(true).people[0].tasks[0].run, 1U);
  EXPECT_TRUE(progress(true).synthetic);
}

TEST_F(CourseCohort, tasksWithoutACriterionAreCountedAndNotJudged) {
  course_.tasks[0].criterion.reset();
  course_.groups.clear();
  const CourseProgress p = progress();
  EXPECT_EQ(p.people.size(), 12U) << "everybody";
  EXPECT_FALSE(p.norms[0]);
  for (const CoursePerson& person : p.people) {
    EXPECT_EQ(person.tasks[0].state, TaskState::practising);
    EXPECT_EQ(person.tasks[0].missing, "");
  }
}

TEST_F(CourseCohort, whatDoesNotFitTheCohortIsNamedWithItsPlace) {
  course_.groups = {"expert"};
  course_.tasks.push_back({"carve-fat", "Carve", "Carve.", CourseCriterion{"clinic", 0, 2, 0, 0}});
  expectFault(ErrorKind::refused, "course.json: /tasks/1/criterion/norm", {"clinic", "touch-liver", "carve-fat"},
              [&] { progress(); });
  course_.tasks[1].criterion->norm = "hospital";
  expectFault(ErrorKind::refused, "course.json: /tasks/1/criterion/norm", {"\"hospital\"", "clinic 1"},
              [&] { progress(); });
  course_.tasks[1].criterion = CourseCriterion{"clinic", 7, 2, 0, 0};
  expectFault(ErrorKind::refused, "course.json: /tasks/1/criterion/norm", {"7"}, [&] { progress(); });
  course_.tasks.pop_back();
  course_.groups.emplace_back("residents");
  expectFault(ErrorKind::refused, "course.json: /groups/1", {"\"residents\"", "expert", "novice"}, [&] { progress(); });
}

TEST_F(CourseCohort, aNormStaysWhereItsVersionIsNamed) {
  add(attempt(60, "T1"), "trainee", 50.0);
  EXPECT_EQ(standing().run, 1U);
  Norm stricter = cohort_.norm("clinic");
  stricter.checkpoints[0].cut = 10.0;
  cohort_.storeNorm(stricter);
  EXPECT_EQ(standing().run, 0U) << "by the newest";
  course_.tasks[0].criterion->normVersion = 1;
  EXPECT_EQ(standing().run, 1U);
  EXPECT_EQ(progress().norms[0]->version, 1U);
}

}  // namespace
}  // namespace calot::analytics

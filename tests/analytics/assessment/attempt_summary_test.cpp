// SPDX-License-Identifier: GPL-3.0-or-later
// What an instructor reads first of an attempt, and what a trainee aims at next.
#include "analytics/assessment/grade.h"

#include <gtest/gtest.h>

#include "analytics/assessment/norm.h"
#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

CheckpointValue of(const char* name, const char* subject, double value) {
  return makeValue(*findCheckpoint(name), subject, Origin::resimulated, value,
                   name == std::string("critical-view") ? "triangle 2, lower third 2, two structures 1" : "");
}
CheckpointValue none(const char* name, Availability kind, const char* reason) {
  return makeMissing(*findCheckpoint(name), "", Origin::resimulated, kind, reason);
}

AttemptRow completed() {
  AttemptRow attempt;
  attempt.complete = true;
  attempt.outcome = recorder::Outcome::completed;
  attempt.verification.verdict = Verdict::verified;
  return attempt;
}

TEST(AttemptSummary, saysVerdictCriticalViewErrorsAndTheFiguresThatCount) {
  const std::vector<CheckpointValue> values{
      of("elapsed-time", "", 61.0),   of("path-length", "left", 0.2),   of("path-length", "right", 0.5),
      of("speed-mean", "left", 0.01), of("organ-burned", "liver", 0.0), of("organ-burned", "gallbladder", 0.01),
      of("critical-view", "", 5.0),   of("clip-errors", "", 2.0),       of("organ-perforations", "liver", 0.0),
      of("critical-errors", "", 1.0)};
  const AttemptSummary summary = summaryOf(completed(), values, nullptr);
  EXPECT_EQ(summary.verdict, "The task was completed. It is not held against a norm.");
  EXPECT_EQ(summary.criticalView,
            "Critical view: satisfactory, 5 of 6 points (triangle 2, lower third 2, two structures 1).");
  EXPECT_EQ(summary.errors,
            "Errors: 1 critical error, 2 clip errors, no perforation; a critical error fails the attempt.");
  ASSERT_EQ(summary.figures.size(), 5U);
  std::vector<std::string_view> shown{"critical-view"};
  for (const KeyFigure& figure : summary.figures) shown.push_back(figure.checkpoint);
  EXPECT_EQ(shown, countingCheckpoints()) << "those that count in a norm's short rule, and no others";
  EXPECT_EQ(summary.figures.back().values.size(), 2U) << "both hands";
}

TEST(AttemptSummary, saysNothingOfWhatTheSceneDoesNotHave) {
  const std::vector<CheckpointValue> values{
      none("critical-view", Availability::notApplicable, "the scene has no procedure"),
      none("clip-errors", Availability::notApplicable, "the scene has no vessels"),
      none("connective-remaining", Availability::notApplicable,
           "no connective tissue holds a gallbladder in this scene"),
      none("elapsed-time", Availability::notApplicable, "not completed: stopped at 4.000 s")};
  const AttemptSummary summary = summaryOf(completed(), values, nullptr);
  EXPECT_EQ(summary.criticalView, "");
  EXPECT_EQ(summary.errors, "Errors: none are judged in this scene.");
  ASSERT_EQ(summary.figures.size(), 1U);
  EXPECT_EQ(summary.figures[0].checkpoint, "elapsed-time") << "that is of the attempt, not of the scene";
  EXPECT_TRUE(sceneLacks(values[2]));
  EXPECT_FALSE(sceneLacks(values[3]));
}

TEST(AttemptSummary, anAttemptThatDivergedSaysSoFirst) {
  AttemptRow attempt = completed();
  attempt.verification.verdict = Verdict::diverged;
  attempt.outcome = recorder::Outcome::stopped;
  EXPECT_EQ(summaryOf(attempt, {}, nullptr).verdict,
            "The task was not completed: stopped. The re-simulation differs: no figure can be relied on. It is not "
            "held against a norm.");
}

TEST(NextGoal, isTheFirstFigureThatCountsAndFellShort) {
  Grade grade;
  const auto figure = [](const char* name, double value, double cut, bool passed, double rank, bool counts) {
    const CheckpointDefinition& d = *findCheckpoint(name);
    GradedFigure made;
    made.mark.checkpoint = name;
    made.mark.direction = d.direction;
    made.mark.cut = cut;
    made.mark.inRule = counts;
    made.title = d.title;
    made.unit = d.displayUnit;
    made.displayFactor = d.displayFactor;
    made.value = value;
    made.passed = passed;
    made.rank = rank;
    return made;
  };
  grade.figures = {
      figure("elapsed-time", 80.0, 60.0, false, 20.0, true), figure("path-length", 0.5, 0.4, false, 10.0, true),
      figure("organ-burned", 0.0, 0.01, true, 50.0, true), figure("speed-mean", 0.0, 0.01, false, 1.0, false)};
  EXPECT_EQ(nextGoal(grade).checkpoint, "path-length") << "the one that lies furthest behind the competent";
  EXPECT_EQ(nextGoal(grade).text, "Path length of the instrument's tip: at most 400 mm (now 500 mm).");
  grade.figures[0].mark.reason = "no interval: fixed by A. Instructor";
  EXPECT_EQ(nextGoal(grade).checkpoint, "elapsed-time") << "a fixed mark has to be passed";
  grade.criticalErrors = 1.0;
  EXPECT_EQ(nextGoal(grade).checkpoint, "critical-errors") << "first of all";
  grade.criticalErrors = 0.0;
  grade.figures.erase(grade.figures.begin(), grade.figures.begin() + 2);
  grade.passed = true;
  EXPECT_EQ(nextGoal(grade).text, "Every figure that counts is passed: the next task, or another norm.");
}

}  // namespace
}  // namespace calot::analytics

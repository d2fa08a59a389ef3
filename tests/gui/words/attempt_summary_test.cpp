// SPDX-License-Identifier: GPL-3.0-or-later
// What an instructor reads first of an attempt, and what a trainee aims at next.
#include "gui/words/attempt_summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "analytics/assessment/norm.h"
#include "analytics/assessment/verdict.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/error_words.h"
#include "analytics/report/key_figures.h"
#include "gui/words/event_words.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

CheckpointValue of(const char* name, const char* subject, double value) {
  const std::string note = name == std::string("critical-view")     ? "triangle 2, lower third 2, two structures 1"
                           : name == std::string("critical-errors") ? "cystic duct left open, 1:40.2"
                           : name == std::string("minor-errors")
                               ? "liver slipped in the jaws, 18 times, worst at 0:31.0"
                               : "";
  return makeValue(*findCheckpoint(name), subject, Origin::resimulated, value, note);
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
      of("critical-errors", "", 1.0), of("major-errors", "", 0.0),      of("minor-errors", "", 18.0)};
  const gui::AttemptSummary summary = gui::summaryOf(completed(), values, nullptr);
  EXPECT_EQ(summary.verdict, "The task was completed. It is not held against a norm.");
  EXPECT_EQ(summary.criticalView,
            "Critical view: satisfactory, 5 of 6 points (triangle 2, lower third 2, two structures 1).");
  EXPECT_EQ(summary.safety, gui::AttemptSummary::Safety::notSafe);
  EXPECT_EQ(summary.errors,
            (std::vector<std::string>{"Not safe: cystic duct left open, 1:40.2.", "No major error.",
                                      "18 minor errors: liver slipped in the jaws, 18 times, worst at 0:31.0."}));
  const std::vector<KeyFigure> figures = keyFigures(values, nullptr);
  std::vector<std::string_view> shown;
  for (const KeyFigure& figure : figures) {
    if (shown.empty() || shown.back() != figure.value.name) shown.push_back(figure.value.name);
  }
  EXPECT_EQ(shown, countingCheckpoints()) << "those that count in a norm's short rule, and no others";
  EXPECT_EQ(figures.size(), shown.size() + 2) << "both hands, two organs";
}

TEST(AttemptSummary, saysNothingOfWhatTheSceneDoesNotHave) {
  const std::vector<CheckpointValue> values{
      none("critical-view", Availability::notApplicable, "the scene has no procedure"),
      none("critical-errors", Availability::notApplicable, "the scene has no procedure"),
      none("clip-errors", Availability::notApplicable, "the scene has no vessels"),
      none("connective-remaining", Availability::notApplicable,
           "no connective tissue holds a gallbladder in this scene"),
      none("elapsed-time", Availability::notApplicable, "not completed: stopped at 4.000 s")};
  const gui::AttemptSummary summary = gui::summaryOf(completed(), values, nullptr);
  EXPECT_EQ(summary.criticalView, "");
  EXPECT_EQ(summary.safety, gui::AttemptSummary::Safety::notAssessed);
  EXPECT_EQ(summary.errors, (std::vector<std::string>{"Critical errors: not assessed, the scene has no procedure."}));
  const std::vector<KeyFigure> figures = keyFigures(values, nullptr);
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_EQ(figures[0].value.name, "elapsed-time") << "that is of the attempt, not of the scene";
  EXPECT_TRUE(sceneLacks(values[3]));
  EXPECT_FALSE(sceneLacks(values[4]));
}

TEST(AttemptSummary, printsCountsWhole) {
  std::ostringstream out;
  gui::printValues({of("clip-errors", "", 2.0), of("path-length", "left", 0.2)}, {}, out);
  std::istringstream lines(out.str());
  std::map<std::string, std::string> shown;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, value;
    words >> name >> value;
    if (value == "left") words >> value;
    shown[name] = value;
  }
  EXPECT_EQ(shown["clip-errors"], "2");
  EXPECT_EQ(shown["path-length"], "200.0");
}

/// Every rule, from the error to the sentence that summary, list, sheet, JSON, page and trainer have.
TEST(AttemptSummary, everyRuleIsSaidInItsWordsWithItsTime) {
  const SubjectNames names{{"cystic-duct"}, {"bed"}};
  for (const ErrorRuleText& rule : errorRules()) {
    const AttemptError error{{rule.rule}, 0, 1, 10021, 10021, 10021, 0.0};
    const std::vector<ErrorLine> lines = linesOf({error}, names, 0.01);
    const SeverityWords words = wordsOf(lines, rule.severity);
    std::vector<CheckpointValue> values;
    for (const auto& [severity, checkpoint] : errorCheckpoints())
      values.push_back(makeValue(*findCheckpoint(checkpoint), "", Origin::resimulated,
                                 severity == rule.severity ? 1.0 : 0.0, severity == rule.severity ? words.lines : ""));
    const char* subject = rule.subject == ErrorSubject::none        ? ""
                          : rule.subject == ErrorSubject::structure ? "cystic duct "
                                                                    : "bed ";
    const std::string said = subject + std::string(rule.words) + ", 1:40.2.";
    const std::string sentence = (rule.severity == Severity::critical ? "Not safe: "
                                  : rule.severity == Severity::major  ? "1 major error: "
                                                                      : "1 minor error: ") +
                                 said;
    expectHolds(fmt::format("{}", fmt::join(gui::summaryOf(completed(), values, nullptr).errors, " ")), {sentence});
    expectHolds(fmt::format("{}", fmt::join(verdictOf({error}, names, 0.01, {}), " ")), {sentence});
    Judgement now;
    now.found = {{rule.rule, {}}};
    ASSERT_EQ(gui::tell(now, names).size(), 1U);
    EXPECT_EQ(gui::tell(now, names)[0].text, subject + std::string(rule.words));
  }
}

TEST(AttemptSummary, figuresOfEarlierRulesSaySo) {
  CheckpointValue early = of("critical-errors", "", 2.0);
  early.version -= 1;
  EXPECT_EQ(errorSentence(Severity::critical, &early),
            fmt::format("Critical errors: 2 by version {} of the rules, which are of version {} now.", early.version,
                        early.version + 1));
}

TEST(AttemptSummary, anAttemptThatDivergedSaysSoFirst) {
  AttemptRow attempt = completed();
  attempt.verification.verdict = Verdict::diverged;
  attempt.outcome = recorder::Outcome::stopped;
  EXPECT_EQ(gui::summaryOf(attempt, {}, nullptr).verdict,
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
  EXPECT_EQ(gui::nextGoal(grade).checkpoint, "path-length") << "the one that lies furthest behind the competent";
  EXPECT_EQ(gui::nextGoal(grade).text, "Path length of the instrument's tip: at most 400.0 mm (now 500.0 mm).");
  grade.figures[0].mark.reason = "no interval: fixed by A. Instructor";
  EXPECT_EQ(gui::nextGoal(grade).checkpoint, "elapsed-time") << "a fixed mark has to be passed";
  grade.figures[0] = figure("clip-errors", 2.0, 0.5, false, 0.0, true);
  grade.figures[0].mark.reason = "no interval: fixed by A. Instructor";
  expectHolds(gui::nextGoal(grade).text, {"at most 0.5000 (now 2)"});
  grade.criticalErrors = 1.0;
  grade.safety = {"Not safe: cystic duct left open."};
  grade.verdict = "Not passed. " + grade.safety.front();
  EXPECT_EQ(gui::summaryOf(completed(), {}, &grade).verdict.find(grade.safety.front()), std::string::npos)
      << "the errors say it";
  EXPECT_EQ(gui::nextGoal(grade).checkpoint, "critical-errors") << "first of all";
  grade.criticalErrors = 0.0;
  grade.figures.erase(grade.figures.begin(), grade.figures.begin() + 2);
  grade.passed = true;
  EXPECT_EQ(gui::nextGoal(grade).text, "Every figure that counts is passed: the next task, or another norm.");
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// How an attempt went, in words: against a norm, and against the last time.
#include "gui/trainer/attempt_report.h"

#include <gtest/gtest.h>

#include <QLocale>

#include "analytics/checkpoints/checkpoint.h"
#include "gui/attempt/figure_text.h"
#include "gui/trainer/scenes_page.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::gui {
namespace {

const analytics::CheckpointDefinition& elapsed() { return *analytics::findCheckpoint("elapsed-time"); }

AttemptFacts factsOf(char digit, double seconds, const std::string& start) {
  AttemptFacts facts;
  analytics::AttemptRow& row = facts.attempt;
  row.uuid = std::string("0000100") + digit + "-0000-4000-8000-000000000001";
  row.participant = std::string("P1");
  row.scene = "touch-liver";
  row.operatorKind = recorder::OperatorKind::human;
  row.comparabilityKey = std::string("k");
  row.startUtc = start;
  row.complete = true;
  row.steps = 4120;
  row.outcome = recorder::Outcome::completed;
  row.verification.verdict = analytics::Verdict::verified;
  facts.values = {analytics::makeValue(elapsed(), "", analytics::Origin::resimulated, seconds)};
  return facts;
}

/// Competent members of 10, 20, ..., 90 s.
analytics::Norm normWith(double cut) {
  analytics::Norm norm;
  norm.name = "clinic";
  norm.comparabilityKey = "k";
  norm.by = "I1";
  norm.judgedBy = std::string("group");
  analytics::NormCheckpoint mark;
  mark.checkpoint = elapsed().name;
  mark.version = elapsed().version;
  mark.inRule = true;
  mark.cut = cut;
  norm.checkpoints = {mark};
  for (int i = 1; i <= 9; ++i) norm.members.push_back({std::string("m").append(std::to_string(i)), true, {10.0 * i}});
  return norm;
}

class Report : public ::testing::Test {
 protected:
  void SetUp() override { QLocale::setDefault(QLocale::c()); }
};

TEST_F(Report, AgainstTheNorm) {
  const AttemptReport good = reportOf(factsOf('1', 40.0, "2026-02-03T10:00:00Z"), std::nullopt, {normWith(60.0)});
  ASSERT_EQ(good.figures.size(), 1U);
  EXPECT_EQ(good.figures[0].title, QString::fromStdString(elapsed().title));
  EXPECT_TRUE(good.figures[0].now.startsWith("40")) << good.figures[0].now.toStdString();
  EXPECT_TRUE(good.figures[0].norm.startsWith("pass mark 60")) << good.figures[0].norm.toStdString();
  EXPECT_TRUE(good.figures[0].norm.contains("half of the competent people 30")) << good.figures[0].norm.toStdString();
  EXPECT_TRUE(good.figures[0].norm.endsWith(": reached"));
  EXPECT_TRUE(good.norm.startsWith("Norm clinic version 1: "));
  const AttemptReport bad = reportOf(factsOf('1', 80.0, "2026-02-03T10:00:00Z"), std::nullopt, {normWith(60.0)});
  EXPECT_TRUE(bad.figures[0].norm.endsWith(": falls short"));
}

TEST_F(Report, WhatIsNotVerifiedIsHeldBesideTheNormAndNotJudged) {
  AttemptFacts facts = factsOf('1', 80.0, "2026-02-03T10:00:00Z");
  facts.attempt.verification.verdict = analytics::Verdict::notChecked;
  const AttemptReport report = reportOf(facts, std::nullopt, {normWith(60.0)});
  EXPECT_TRUE(report.norm.contains("judged when the attempt is verified")) << report.norm.toStdString();
  EXPECT_TRUE(report.figures[0].norm.startsWith("pass mark 60"));
  EXPECT_FALSE(report.figures[0].norm.contains("falls short"));
}

TEST_F(Report, AFigureWithoutANumberSaysWhy) {
  AttemptFacts facts = factsOf('1', 80.0, "2026-02-03T10:00:00Z");
  facts.values[0].value.reset();
  facts.values[0].availability = analytics::Availability::notAvailable;
  facts.values[0].reason = "not completed: abandoned at 5.540 s";
  EXPECT_EQ(reportOf(facts, std::nullopt, {}).figures[0].now, "not completed: abandoned at 5.540 s");
}

TEST_F(Report, AnotherTasksNormIsNone) {
  analytics::Norm other = normWith(60.0);
  other.comparabilityKey = "another";
  const AttemptReport report = reportOf(factsOf('1', 80.0, "2026-02-03T10:00:00Z"), std::nullopt, {other});
  EXPECT_EQ(report.norm, "No norm for this task, device and mode.");
  EXPECT_EQ(report.figures[0].norm, "");
}

TEST_F(Report, AgainstTheLastTime) {
  const auto before = [](double now, double then) {
    return reportOf(factsOf('2', now, "2026-02-04T10:00:00Z"), factsOf('1', then, "2026-02-03T10:00:00Z"), {})
        .figures[0]
        .before;
  };
  EXPECT_TRUE(before(40.0, 52.5).startsWith("52.5")) << before(40.0, 52.5).toStdString();
  EXPECT_TRUE(before(40.0, 52.5).contains(", better by 12.5"));
  EXPECT_TRUE(before(52.5, 40.0).contains(", worse by 12.5"));
  EXPECT_TRUE(before(40.0, 40.0).endsWith(", the same"));
  const AttemptReport first = reportOf(factsOf('1', 40.0, "2026-02-03T10:00:00Z"), std::nullopt, {});
  EXPECT_EQ(first.figures[0].before, "");
  EXPECT_TRUE(first.previous.startsWith("No earlier attempt"));
}

TEST_F(Report, WhoDidNotCompleteTheTaskWasNotBetterAtIt) {
  AttemptFacts now = factsOf('2', 40.0, "2026-02-04T10:00:00Z");
  now.attempt.outcome = recorder::Outcome::abandoned;
  const AttemptFacts then = factsOf('1', 52.5, "2026-02-03T10:00:00Z");
  EXPECT_TRUE(reportOf(now, then, {}).figures[0].before.contains(", now less by 12.5"));
  now.values[0].value = 1e-11;  // of rounding alone
  AttemptFacts still = then;
  still.values[0].value = 2e-11;
  EXPECT_TRUE(reportOf(now, still, {}).figures[0].before.endsWith(", the same"));
}

/// A cohort with attempts of P1 and others.
class InCohort : public Report {
 protected:
  void store(const AttemptFacts& facts) {
    analytics::CohortDatabase database(cohort_.string(), analytics::CohortDatabase::Access::create);
    database.storeAttempt(facts.attempt, facts.values);
  }
  recorder::test::Folder folder_;
  std::filesystem::path cohort_ = folder_ / "c.db";
};

TEST_F(InCohort, TheLastTimeIsTheParticipantsOwnAtTheSameTask) {
  const AttemptFacts now = factsOf('9', 40.0, "2026-02-09T10:00:00Z");
  EXPECT_FALSE(previousInCohort(now, cohort_)) << "there is no cohort yet";
  EXPECT_FALSE(previousInCohort(now, {}));
  store(factsOf('1', 10.0, "2026-02-01T10:00:00Z"));
  store(factsOf('2', 20.0, "2026-02-02T10:00:00Z"));
  AttemptFacts other = factsOf('3', 30.0, "2026-02-03T10:00:00Z");
  other.attempt.participant = "P2";
  store(other);
  other = factsOf('4', 30.0, "2026-02-04T10:00:00Z");
  other.attempt.comparabilityKey = "another task";
  store(other);
  other = factsOf('5', 30.0, "2026-02-05T10:00:00Z");
  other.attempt.complete = false;
  store(other);
  store(factsOf('6', 60.0, "2026-02-10T10:00:00Z"));  // later
  store(now);
  const std::optional<AttemptFacts> found = previousInCohort(now, cohort_);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->attempt.startUtc, "2026-02-02T10:00:00Z");
  ASSERT_EQ(found->values.size(), 1U);
  AttemptFacts nobody = now;
  nobody.attempt.participant.clear();
  EXPECT_FALSE(previousInCohort(nobody, cohort_)) << "nobody's attempts are no one's history";
}

TEST_F(InCohort, TheHistoryIsThePersonsTheNewestFirst) {
  EXPECT_TRUE(historyIn(cohort_, "P1").empty());
  store(factsOf('1', 10.0, "2026-02-01T10:00:00Z"));
  AttemptFacts other = factsOf('2', 30.0, "2026-02-02T10:00:00Z");
  other.attempt.participant = "P2";
  store(other);
  other = factsOf('3', 30.0, "2026-02-03T10:00:00Z");
  other.attempt.outcome = recorder::Outcome::abandoned;
  store(other);
  other = factsOf('4', 30.0, "2026-02-04T10:00:00Z");
  other.attempt.operatorKind = recorder::OperatorKind::performer;
  other.attempt.synthetic = true;
  store(other);
  const std::vector<PastAttempt> history = historyIn(cohort_, "P1");
  ASSERT_EQ(history.size(), 2U) << "a performer's demonstration is no attempt of theirs";
  EXPECT_EQ(history[0].outcome, recorder::Outcome::abandoned);
  EXPECT_EQ(progressText(history, "touch-liver"), QString::fromUtf8("✓ 2 attempts, 1 completed"));
  EXPECT_EQ(progressText(history, "carve-fat"), "Not tried yet");
  EXPECT_EQ(pastText(history[1]), startText("2026-02-01T10:00:00Z") + ", practice: completed after 0:41.2");
}

TEST(TrainingHistory, AttemptsThatPassTheNormAreSaid) {
  std::vector<PastAttempt> history(3);
  for (PastAttempt& past : history) past.scene = "carve-fat";
  history[0].branch = true;  // of a part; no attempt of its own
  history[2].passed = true;
  EXPECT_EQ(progressText(history, "carve-fat"), QString::fromUtf8("✓ 2 attempts, passed by the norm"));
}

}  // namespace
}  // namespace calot::gui

// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions by a norm: members judged by marks made without them, people graded twice, and grades near the mark.
#include "analytics/assessment/norm_decision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/assessment/grade.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using support::humanAttempt;
using support::uuidOf;

/// Six experts about 40 and six novices about 60, each with two attempts that differ by `apart`; the left path alone.
class Decisions : public testing::Test {
 protected:
  Decisions() : cohort_(folder_.file("c.db"), CohortDatabase::Access::create) {
    request_.name = "clinic";
    request_.by = "me";
    request_.who.attemptRule = AttemptRule::first;
  }

  void fill(double apart, unsigned twice = 12) {
    for (unsigned i = 0; i < 12; ++i) {
      const bool expert = i < 6;
      const std::string who = fmt::format("{}{}", expert ? "E" : "N", i);
      cohort_.addParticipant({who, expert ? "expert" : "novice", "", "", {}, {}});
      const double value = (expert ? 40.0 : 60.0) + 2.0 * (i % 6);
      add(2 * i, who, value);
      if (i < twice) add(2 * i + 1, who, value + (i % 2 == 0 ? apart : -apart));
    }
  }

  void add(unsigned n, const std::string& who, double left) {
    AttemptRecord attempt = humanAttempt(n, who);
    attempt.startUtc = fmt::format("2026-01-01T10:{:02}:00Z", n);
    cohort_.storeAttempt(attempt, {makeValue(*findCheckpoint("path-length"), "left", Origin::samples, left)});
  }

  Norm made() { return makeNorm(cohort_.listAttempts(), cohort_.allValues(), {}, request_, "c.db"); }
  NormDecisions decided(const Norm& norm) { return decisionsOf(norm, cohort_.listAttempts(), cohort_.allValues(), {}); }

  support::Folder folder_;
  CohortDatabase cohort_;
  NormRequest request_;
};

TEST_F(Decisions, membersWhoAreFarApartAreJudgedRightWithAnInterval) {
  fill(1.0);
  const NormDecisions d = decided(made());
  EXPECT_EQ(d.falsePass.hits, 0U);
  EXPECT_EQ(d.falsePass.of, 6U);
  EXPECT_EQ(d.falseFail.hits, 0U);
  // R 4.2.2: prop.test(0, 6, correct = FALSE)
  EXPECT_NEAR(d.falsePass.share->interval.upper, 0.3903343, 1e-7);
  EXPECT_EQ(d.falsePass.share->interval.lower, 0.0);
  EXPECT_EQ(d.agreement.hits, 12U);
  EXPECT_EQ(d.agreement.of, 12U);
  EXPECT_NEAR(*d.kappa, 1.0, 1e-12);
  EXPECT_EQ(d.graded, 24U);
  EXPECT_EQ(d.near, 0U);
}

TEST_F(Decisions, aMemberIsJudgedByMarksMadeWithoutThem) {
  fill(1.0);
  // The best novice lies among the experts: with them the mark is more lenient than without.
  cohort_.addParticipant({"N99", "novice", "", "", {}, {}});
  add(40, "N99", 54.0);
  const Norm norm = made();
  const double with = *norm.checkpoints[0].cut;
  EXPECT_LT(with, 54.0);
  cohort_.excludeAttempts({uuidOf(40)}, "test", "me");
  const double without = *made().checkpoints[0].cut;
  EXPECT_GT(without, with);
  cohort_.includeAttempts({uuidOf(40)}, "test", "me");
  const auto [competent, others] = passRates(norm);
  EXPECT_EQ(others.passed, 0U);
  EXPECT_EQ(decided(norm).falsePass.hits, 54.0 <= without ? 1U : 0U);
}

TEST_F(Decisions, aTrialSaysWhoWouldPassBeforeTheNormIsMade) {
  fill(1.0);
  cohort_.addParticipant({"N99", "novice", "", "", {}, {}});
  add(40, "N99", 54.0);
  const auto gathered = [this] {
    return gatherNorm(cohort_.listAttempts(), cohort_.allValues(), {}, request_, "c.db");
  };
  const Norm members = gathered();
  EXPECT_EQ(sidesOf(members), std::pair(std::size_t{6}, std::size_t{7}));
  EXPECT_FALSE(members.checkpoints[0].cut) << "no mark yet";
  const NormTrial trial = tryNorm(members, {}, request_);
  EXPECT_DOUBLE_EQ(*trial.norm.checkpoints[0].cut, *made().checkpoints[0].cut);
  EXPECT_EQ(trial.rates.first.passed, 6U);
  EXPECT_EQ(trial.rates.second.passed, 0U);
  // Without N99 the groups have one spread, and the mark is between their means: (45 + 65) / 2 = 55 m, above its 54.
  EXPECT_EQ(trial.withoutSelf.second.passed, 1U);
  EXPECT_EQ(trial.withoutSelf.second.members, 7U);
  EXPECT_EQ(trial.withoutSelf.first.passed, 6U);
  // 40, 42 and 44 m of six experts pass a person's mark, which stays whoever is left out.
  request_.fixed = {{"path-length left", false, 44000.0}};
  const NormTrial byHand = tryNorm(members, {}, request_);
  EXPECT_EQ(byHand.rates.first.passed, 3U);
  EXPECT_EQ(byHand.withoutSelf.first.passed, 3U);
  EXPECT_EQ(byHand.computed, trial.computed);
  EXPECT_EQ(std::count(byHand.passed.begin(), byHand.passed.end(), true), 3);
  // Nothing counts: nobody fails.
  request_.fixed.clear();
  request_.checkpoints = {"elapsed-time"};
  EXPECT_EQ(tryNorm(members, {}, request_).rates.second.passed, 7U);
}

TEST_F(Decisions, membersAreWhoAPersonDecidesTheyAre) {
  fill(1.0);
  const Norm byGroups = made();
  request_.decided = {{uuidOf(0), std::nullopt}, {uuidOf(2), false}, {uuidOf(4), true}, {"nobody", false}};
  const Norm norm = made();
  EXPECT_EQ(sidesOf(norm), std::pair(std::size_t{4}, std::size_t{7}));
  EXPECT_EQ(norm.members.size(), 11U);
  EXPECT_EQ(norm.membersMade, 11U);
  expectHolds(norm.judgedBy, {byGroups.judgedBy, "2 of 12", request_.by});
  // The path of 42 m is one of the others' now: the mark is stricter.
  EXPECT_NE(*norm.checkpoints[0].cut, *byGroups.checkpoints[0].cut);
  for (unsigned n : {6U, 8U}) request_.decided[uuidOf(n)] = false;
  EXPECT_THROW(made(), Error) << "two are no side";
}

TEST_F(Decisions, aNormIsTakenOutAgainUnlessItHasANewerVersionOrEvidence) {
  fill(1.0);
  const Norm norm = made();
  const auto refused = [&](const std::string& name, std::uint32_t version) {
    EXPECT_THROW(cohort_.removeNorm(name, version, "me"), Error) << name << ' ' << version;
  };
  EXPECT_EQ(cohort_.storeNorm(norm), 1U);
  EXPECT_EQ(cohort_.storeNorm(norm), 2U);
  refused("clinic", 1);
  refused("clinic", 3);
  refused("other", 1);
  EXPECT_THROW(cohort_.removeNorm("clinic", 2, ""), Error);
  cohort_.removeNorm("clinic", 2, "me");
  EXPECT_EQ(cohort_.norms().size(), 1U);
  EXPECT_EQ(cohort_.storeNorm(norm), 2U) << "the number is given again";
  cohort_.attachEvidence(cohort_.norm("clinic"), {"it predicts", "r.pdf", std::string(64, 'a'), "me", ""});
  refused("clinic", 2);
  EXPECT_EQ(cohort_.norm("clinic").members.size(), norm.members.size());
}

TEST_F(Decisions, theErrorOfMeasurementIsThatOfRepeatedAttempts) {
  fill(4.0);
  const Norm norm = made();
  const auto errors = markErrors(norm, cohort_.listAttempts(), cohort_.allValues());
  ASSERT_TRUE(errors[0]);
  EXPECT_EQ(errors[0]->people, 12U);
  EXPECT_NEAR(errors[0]->value, 4.0 / std::sqrt(2.0), 1e-9);  // each pair's variance is 16 / 2
}

TEST_F(Decisions, ofFewRepeatersTheErrorIsThatOfTheMark) {
  fill(4.0, 4);
  const Norm norm = made();
  const auto errors = markErrors(norm, cohort_.listAttempts(), cohort_.allValues());
  ASSERT_TRUE(errors[0]);
  EXPECT_EQ(errors[0]->people, 0U);
  EXPECT_NEAR(errors[0]->value, (*norm.checkpoints[0].upper - *norm.checkpoints[0].lower) / (2.0 * 1.959963984540054),
              1e-9);
  EXPECT_EQ(decided(norm).agreement.of, 4U);
}

TEST_F(Decisions, aGradeWithinOneStandardErrorIsCalledSo) {
  fill(6.0);
  const Norm norm = made();
  const double cut = *norm.checkpoints[0].cut;
  const auto grade = [&](unsigned n, double left) {
    cohort_.addParticipant({fmt::format("T{}", n), "", "", "", {}, {}});
    add(n, fmt::format("T{}", n), left);
    return gradeAttempt(*cohort_.attempt(uuidOf(n)), cohort_.listAttempts(), cohort_.allValues(), norm, false, "c.db");
  };
  const Grade near = grade(50, cut - 1.0), far = grade(51, cut - 20.0);
  EXPECT_TRUE(near.passed);
  EXPECT_TRUE(near.near);
  EXPECT_TRUE(near.figures[0].near);
  EXPECT_EQ(near.figures[0].error->people, 12U);
  EXPECT_TRUE(far.passed);
  EXPECT_FALSE(far.near);
  EXPECT_GE(decided(norm).near, 1U);
}

TEST_F(Decisions, nobodyGradedTwiceIsSaid) {
  fill(1.0, 0);
  const NormDecisions d = decided(made());
  EXPECT_FALSE(d.agreement.share);
  EXPECT_FALSE(d.kappa);
  EXPECT_EQ(d.falseFail.of, 6U);
}

}  // namespace
}  // namespace calot::analytics

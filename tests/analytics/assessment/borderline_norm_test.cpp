// SPDX-License-Identifier: GPL-3.0-or-later
// A norm by borderline regression, from a cohort's attempts and their ratings.
#include "analytics/assessment/norm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using support::humanAttempt;
using support::uuidOf;

/// Ten people, two of each rating from 1 to 5; the left path is 100 - 10 rating, one above and one below by 1.
class BorderlineNorm : public testing::Test {
 protected:
  BorderlineNorm() : cohort_(folder_.file("c.db"), CohortDatabase::Access::create) {
    for (unsigned i = 0; i < 10; ++i)
      add(i, fmt::format("P{}", i), 1 + static_cast<int>(i / 2), i % 2 == 0 ? 1.0 : -1.0);
    request_.name = "clinic";
    request_.by = "me";
    request_.borderline = BorderlineMark{"global", 3.0};
  }

  void add(unsigned n, const std::string& who, int rating, double error) {
    if (!support::findParticipant(cohort_, who)) cohort_.addParticipant({who, "", "", "", {}, {}});
    cohort_.storeAttempt(humanAttempt(n, who), {makeValue(*findCheckpoint("path-length"), "left", Origin::samples,
                                                          100.0 - 10.0 * rating + error)});
    rate(n, "R1", rating);
  }

  void rate(unsigned n, const std::string& rater, int score) {
    Rating r;
    r.form = std::string("global");
    r.attempt = uuidOf(n);
    r.rater = rater;
    r.answers[std::string("score")] = score;
    ratings_.push_back(r);
  }

  Norm made() { return makeNorm(cohort_.listAttempts(), cohort_.allValues(), ratings_, request_, "c.db"); }

  support::Folder folder_;
  CohortDatabase cohort_;
  NormRequest request_;
  std::vector<Rating> ratings_;
};

TEST_F(BorderlineNorm, aPassMarkIsTheLineAtTheMark) {
  const Norm norm = made();
  ASSERT_EQ(norm.checkpoints.size(), 1U);
  const NormCheckpoint& left = norm.checkpoints[0];
  ASSERT_TRUE(left.cut) << left.reason;
  EXPECT_NEAR(*left.cut, 70.0, 1e-9);
  // The mark is the ratings' mean, so that half the interval is t(.975, 8) s / sqrt(10), s^2 = 10 / 8.
  const double half = 2.3060041350333704 * std::sqrt(10.0 / 8.0) / std::sqrt(10.0);
  EXPECT_NEAR(*left.lower, 70.0 - half, 1e-9);
  EXPECT_NEAR(*left.upper, 70.0 + half, 1e-9);
  EXPECT_TRUE(isByBorderline(norm));
  expectNames(norm.judgedBy, {"global", "3"});
  // At the mark and above are six, of whom one at the mark is above the cut and fails.
  const auto [competent, others] = passRates(norm);
  EXPECT_EQ(competent.members, 6U);
  EXPECT_EQ(competent.passed, 5U);
  EXPECT_EQ(others.members, 4U);
  EXPECT_EQ(others.passed, 0U);
}

TEST_F(BorderlineNorm, ofSeveralRatersTheMeanCounts) {
  for (unsigned i = 0; i < 10; ++i) rate(i, "R2", 2 + static_cast<int>(i / 2));  // more lenient by one
  // Ratings are now higher by a half, so that at the mark of 3 one is half a point worse: 5 more on the path.
  EXPECT_NEAR(*made().checkpoints[0].cut, 75.0, 1e-9);
}

TEST_F(BorderlineNorm, theFirstRatedAttemptOfAParticipantCounts) {
  add(20, "P9", 1, 500.0);  // later
  request_.who.attemptRule = AttemptRule::first;
  EXPECT_NEAR(*made().checkpoints[0].cut, 70.0, 1e-9);
}

TEST_F(BorderlineNorm, isRefusedWhereRatingsDoNotSay) {
  request_.borderline->mark = 6.0;
  expectFault(ErrorKind::refused, "", {belowMarkGroup}, [&] { (void)made(); });
  request_.borderline = BorderlineMark{"another", 3.0};
  expectFault(ErrorKind::refused, "", {"another"}, [&] { (void)made(); });
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/cusum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analytics/statistics/resampling.h"

namespace calot::analytics {
namespace {

const CusumGoal goal{0.05, 0.15, 0.1, 0.1};

TEST(Cusum, stepsAndLimitsOfBothForms) {
  const auto log = CusumDesign::logLikelihood(goal), scaled = CusumDesign::scaled(goal);
  ASSERT_TRUE(log && scaled);
  EXPECT_NEAR(log->failureStep(), 1.098612289, 5e-10);
  EXPECT_NEAR(log->successStep(), -0.1112256351, 5e-11);
  EXPECT_NEAR(log->upperLimit(), 2.197224577, 5e-10);
  EXPECT_NEAR(scaled->failureStep(), 0.9080656732, 5e-11);
  EXPECT_NEAR(scaled->successStep(), -0.0919343268, 5e-11);
  EXPECT_NEAR(scaled->upperLimit(), 1.816131346, 5e-10);
  EXPECT_NEAR(scaled->failureStep() - scaled->successStep(), 1.0, 1e-15);
  // alpha = beta: the limits lie opposite.
  EXPECT_NEAR(log->lowerLimit(), -log->upperLimit(), 1e-15);
}

TEST(Cusum, bothFormsDecideAlike) {
  const std::uint64_t seed = 11;
  RandomStream random(seed);
  for (int round = 0; round < 300; ++round) {
    std::vector<bool> failures;
    const double rate = round % 2 == 0 ? 0.05 : 0.2;
    for (int i = 0; i < 60; ++i) failures.push_back(random.uniform() < rate);
    for (const CusumKind kind : {CusumKind::sequential, CusumKind::monitoring}) {
      const CusumChart log = cusum(*CusumDesign::logLikelihood(goal), failures, kind);
      const CusumChart scaled = cusum(*CusumDesign::scaled(goal), failures, kind);
      EXPECT_EQ(log.unacceptable, scaled.unacceptable);
      EXPECT_EQ(log.acceptable, scaled.acceptable);
    }
  }
}

TEST(Cusum, limitsAreReachedWhereTheyAreMetExactly) {
  // Two failures in a row: 2 ln 3 = ln 9, the limit itself, whatever the rounding.
  for (const auto& design : {CusumDesign::logLikelihood(goal), CusumDesign::scaled(goal)}) {
    const CusumChart chart = cusum(*design, {true, true, false}, CusumKind::sequential);
    EXPECT_EQ(chart.unacceptable, 1U);
    EXPECT_FALSE(chart.acceptable);
    ASSERT_EQ(chart.sums.size(), 3U);
    EXPECT_NEAR(chart.sums[2], 2.0 * design->failureStep() + design->successStep(), 1e-15);
    // ceil(2.197224577 / .1112256351) = 20 successes in a row reach the other one.
    const CusumChart good = cusum(*design, std::vector<bool>(30, false), CusumKind::sequential);
    EXPECT_EQ(good.acceptable, 19U);
    const CusumChart held = cusum(*design, std::vector<bool>(30, false), CusumKind::monitoring);
    EXPECT_DOUBLE_EQ(held.sums.back(), 0.0);
    EXPECT_FALSE(held.acceptable);
  }
}

TEST(Cusum, errorsStayBelowWhatWasDeclared) {
  // Wald's bounds: P(call p0 unacceptable) <= alpha / (1 - beta), P(call p1 acceptable) <= beta / (1 - alpha).
  const std::uint64_t seed = 1947;
  RandomStream random(seed);
  const CusumDesign design = *CusumDesign::logLikelihood(goal);
  const int runs = 4000;
  int wronglyBad = 0, wronglyGood = 0;
  for (int run = 0; run < runs; ++run) {
    std::vector<bool> good, bad;
    for (int i = 0; i < 600; ++i) {
      good.push_back(random.uniform() < goal.acceptable);
      bad.push_back(random.uniform() < goal.unacceptable);
    }
    if (cusum(design, good, CusumKind::sequential).unacceptable) ++wronglyBad;
    if (cusum(design, bad, CusumKind::sequential).acceptable) ++wronglyGood;
  }
  const double bound = 0.1 / 0.9, chance = 4.0 * std::sqrt(bound * (1.0 - bound) / runs);
  EXPECT_LE(wronglyBad / static_cast<double>(runs), bound + chance);
  EXPECT_LE(wronglyGood / static_cast<double>(runs), bound + chance);
  EXPECT_GT(wronglyBad, 0);
  EXPECT_GT(wronglyGood, 0);
}

TEST(Cusum, refusals) {
  EXPECT_EQ(CusumDesign::logLikelihood({0.0, 0.1, 0.1, 0.1}).reason(), "a failure rate is not between 0 and 1");
  EXPECT_EQ(CusumDesign::scaled({0.2, 0.2, 0.1, 0.1}).reason(),
            "the acceptable failure rate is not below the unacceptable one");
  EXPECT_EQ(CusumDesign::scaled({0.1, 0.2, 0.6, 0.5}).reason(), "alpha and beta are not positive with a sum below 1");
  EXPECT_EQ(CusumDesign::scaled({0.1, NAN, 0.1, 0.1}).reason(), "a failure rate is not between 0 and 1");
  EXPECT_TRUE(cusum(*CusumDesign::scaled(goal), {}, CusumKind::sequential).sums.empty());
}

}  // namespace
}  // namespace calot::analytics

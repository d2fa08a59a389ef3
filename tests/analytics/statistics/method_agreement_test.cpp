// SPDX-License-Identifier: GPL-3.0-or-later
// Bland and Altman's limits, Deming's line, the interval of Spearman's correlation.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/reliability.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// Peak expiratory flow (l/min) of 17 people by two meters: Bland and Altman (1986, Lancet 327:307), table 1.
const data::Values large{494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427};
const data::Values mini{512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451};

TEST(BlandAltman, peakFlow) {
  // Published: bias -2.1, deviation 38.8. R 4.2.2: d <- large - mini; t.test(d)$conf.int; mean(d) -+ qnorm(.975) sd(d),
  // -+ qt(.975, 16) sd(d) sqrt(1 / 17 + qnorm(.975)^2 / 32).
  const auto r = blandAltman(large, mini);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->bias, -2.11764705882353, 1e-12);
  EXPECT_NEAR(r->deviation, 38.7651298736074, 1e-12);
  EXPECT_NEAR(r->biasInterval.lower, -22.0488376966452, 1e-11);
  EXPECT_NEAR(r->biasInterval.upper, 17.8135435789981, 1e-11);
  EXPECT_NEAR(r->lower, -78.0959054671117, 1e-11);
  EXPECT_NEAR(r->upper, 73.8606113494646, 1e-11);
  EXPECT_NEAR(r->lowerInterval.lower, -112.851553139311, 1e-10);
  EXPECT_NEAR(r->lowerInterval.upper, -43.3402577949126, 1e-10);
  EXPECT_NEAR(r->upperInterval.lower, 39.1049636772655, 1e-10);
  EXPECT_NEAR(r->upperInterval.upper, 108.616259021664, 1e-10);
}

TEST(BlandAltman, refuses) {
  expectDistinct({blandAltman(large, data::Values{1, 2}).reason(),
                  blandAltman(data::Values{1, 2}, data::Values{1, 2}).reason(), blandAltman(large, large).reason()});
}

TEST(DemingRegression, peakFlow) {
  // R 4.2.2, first principal axis of (x, y / sqrt(ratio)): e <- eigen(cov(cbind(x, y / sqrt(r))))$vectors[, 1]; b <-
  // e[2] / e[1] * sqrt(r); jackknife of both.
  const auto r = demingRegression(large, mini);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->slope, 0.970880819764939, 1e-12);
  EXPECT_NEAR(r->intercept, 15.2315555223309, 1e-10);
  EXPECT_NEAR(r->slopeError, 0.139017094560376, 1e-11);
  EXPECT_NEAR(r->interceptError, 69.4795333626697, 1e-9);
  EXPECT_NEAR(r->slopeInterval.lower, 0.674572896739185, 1e-11);
  EXPECT_NEAR(r->slopeInterval.upper, 1.26718874279069, 1e-11);
  const auto twice = demingRegression(large, mini, 2.0);
  EXPECT_NEAR(twice->slope, 0.951884506395021, 1e-12);
  EXPECT_NEAR(twice->slopeError, 0.13562528311456, 1e-11);
  EXPECT_NEAR(twice->interceptInterval.upper, 167.701181372822, 1e-8);
}

TEST(DemingRegression, isSymmetricInTheMethods) {
  // Exchanged, with the inverse ratio, the slope is the inverse: least squares is not.
  const auto there = demingRegression(large, mini, 2.0), back = demingRegression(mini, large, 0.5);
  EXPECT_NEAR(there->slope * back->slope, 1.0, 1e-12);
  const data::Values falling{5, 4, 3.5, 2, 1}, x{1, 2, 3, 4, 5};
  EXPECT_LT(demingRegression(x, falling)->slope, 0.0);
  expectNames(demingRegression(data::Values{1, 2, 3}, data::Values{1, 2, 3}).reason(), {});
  expectNames(demingRegression(data::Values{1, 1, 1, 1}, data::Values{1, 2, 3, 4}).reason(), {});
}

TEST(SpearmanInterval, ofR) {
  // R 4.2.2: rho <- cor(mtcars$mpg, mtcars$wt, method = "spearman"); tanh(atanh(rho) -+ qnorm(.975) sqrt((1 + rho^2 /
  // 2) / 29)).
  const auto r = spearman(data::mpg, data::weight);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->rho, -0.886422033270298, 1e-13);
  const auto i = spearmanInterval(r->rho, data::mpg.size());
  EXPECT_NEAR(i->lower, -0.950265882378298, 1e-12);
  EXPECT_NEAR(i->upper, -0.751081976970414, 1e-12);
  expectDistinct({spearmanInterval(1.0, 10).reason(), spearmanInterval(0.5, 3).reason()});
}

TEST(KruskalWallis, epsilonSquared) {
  // R 4.2.2: kruskal.test(Ozone ~ Month, airquality)$statistic / (116 - 1).
  const std::vector<data::Values> ozone{data::ozone5, data::ozone6, data::ozone7, data::ozone8, data::ozone9};
  EXPECT_NEAR(kruskalWallis(ozone)->epsilonSquared, 0.254491967879278, 1e-13);
  // The ranks' variance between the groups, 16, over that of all, 17.5.
  const std::vector<data::Values> apart{{1, 2}, {3, 4}, {5, 6}};
  EXPECT_NEAR(kruskalWallis(apart)->epsilonSquared, 16.0 / 17.5, 1e-14);
}

}  // namespace
}  // namespace calot::analytics

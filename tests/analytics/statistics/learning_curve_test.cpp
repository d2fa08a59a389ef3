// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/regression.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

const Values attempts{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
// Twelve times (s), made up for this test.
const Values times{128.3, 96.5, 83.9, 80.2, 71.6, 70.9, 66.0, 66.8, 63.1, 64.4, 61.9, 60.7};

TEST(LearningCurve, inverseAsRsLm) {
  // R 4.2.2: lm(y ~ I(1 / x)).
  const auto c = fitLearningCurve(attempts, times);
  ASSERT_TRUE(c) << c.reason();
  EXPECT_NEAR(c->plateau, 57.13794054820816, 1e-12);
  EXPECT_NEAR(c->gap, -73.68004854679707, 1e-12);
  EXPECT_NEAR(c->plateauError, 1.01046940622941, 1e-13);
  EXPECT_NEAR(c->gapError, 2.79807829473969, 1e-13);
  EXPECT_NEAR(c->residualSumOfSquares, 59.69668700713602, 1e-11);
  EXPECT_NEAR(c->at(4), 57.13794054820816 + 73.68004854679707 / 4, 1e-12);
}

TEST(LearningCurve, bandIsThatOfALinearFit) {
  // numpy 1.24: s^2 (X'X)^-1 of X = [1, -1/x], Student's t of 10 degrees of freedom.
  const auto c = fitLearningCurve(attempts, times);
  ASSERT_TRUE(c);
  const std::array<std::array<double, 3>, 3> expected{{{1.0, 125.93587674431294, 135.7001014456978},
                                                       {4.0, 73.98549341588895, 77.13041195392603},
                                                       {12.0, 61.36384925824786, 65.1920399293014}}};
  for (const auto& [x, lower, upper] : expected) {
    const auto band = bandOf(*c, x);
    EXPECT_NEAR(band.lower, lower, 1e-8) << x;
    EXPECT_NEAR(band.upper, upper, 1e-8) << x;
  }
}

TEST(LearningCurve, isAMinimum) {
  // No neighbour, whichever way, has a smaller sum of squares.
  const unsigned seed = 12;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 60; ++round) {
    Values y;
    for (const double x : attempts) y.push_back(60.0 + 50.0 * std::exp(-0.4 * x) + 4.0 * normal(random));
    const auto c = fitLearningCurve(attempts, y);
    ASSERT_TRUE(c) << c.reason();
    const auto sum = [&](const LearningCurve& curve) {
      double s = 0.0;
      for (std::size_t i = 0; i < y.size(); ++i) s += std::pow(y[i] - curve.at(attempts[i]), 2);
      return s;
    };
    EXPECT_NEAR(sum(*c), c->residualSumOfSquares, 1e-9 * c->residualSumOfSquares);
    for (double LearningCurve::*parameter : {&LearningCurve::plateau, &LearningCurve::gap}) {
      for (const double factor : {0.999, 1.001}) {
        LearningCurve near = *c;
        near.*parameter *= factor;
        EXPECT_GE(sum(near), c->residualSumOfSquares);
      }
    }
  }
}

TEST(LearningCurve, refusals) {
  const auto reason = [](const Values& x, const Values& y) { return fitLearningCurve(x, y).reason(); };
  EXPECT_EQ(reason({1, 1, 1}, {3, 2, 1}), reason({1, 2}, {3, 2}));
  expectDistinct({reason(attempts, Values(12, 5.0)), reason({1, 2}, {3, 2}), reason({0, 1, 2}, {3, 2, 1}),
                  reason({1, 2}, {3, 2, 1}), reason({1, 2, 3}, {3, 2, NAN})});
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/learning_curve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

const Values attempts{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
// Twelve times (s), made up for this test.
const Values times{128.3, 96.5, 83.9, 80.2, 71.6, 70.9, 66.0, 66.8, 63.1, 64.4, 61.9, 60.7};

TEST(LearningCurve, inverseAsRsLm) {
  // R 4.2.2: lm(y ~ I(1 / x)).
  const auto c = fitLearningCurve(CurveShape::inverse, attempts, times);
  ASSERT_TRUE(c) << c.reason();
  EXPECT_NEAR(c->plateau, 57.13794054820816, 1e-12);
  EXPECT_NEAR(c->gap, -73.68004854679707, 1e-12);
  EXPECT_NEAR(c->plateauError, 1.01046940622941, 1e-13);
  EXPECT_NEAR(c->gapError, 2.79807829473969, 1e-13);
  EXPECT_NEAR(c->residualSumOfSquares, 59.69668700713602, 1e-11);
  EXPECT_FALSE(c->rateError);
  EXPECT_NEAR(c->at(4), 57.13794054820816 + 73.68004854679707 / 4, 1e-12);
}

TEST(LearningCurve, bandIsThatOfALinearFit) {
  // numpy 1.24: s^2 (X'X)^-1 of X = [1, -1/x], Student's t of 10 degrees of freedom.
  const auto c = fitLearningCurve(CurveShape::inverse, attempts, times);
  ASSERT_TRUE(c);
  const std::array<std::array<double, 3>, 3> expected{{{1.0, 125.93587674431294, 135.7001014456978},
                                                       {4.0, 73.98549341588895, 77.13041195392603},
                                                       {12.0, 61.36384925824786, 65.1920399293014}}};
  for (const auto& [x, lower, upper] : expected) {
    const auto band = bandOf(*c, x);
    ASSERT_TRUE(band) << band.reason();
    EXPECT_NEAR(band->lower, lower, 1e-8) << x;
    EXPECT_NEAR(band->upper, upper, 1e-8) << x;
  }
  const auto power = fitLearningCurve(CurveShape::power, attempts, times);
  ASSERT_TRUE(power);
  EXPECT_FALSE(bandOf(*power, 4.0)) << "not linear in its rate";
}

TEST(LearningCurve, powerAndExponentialAsRsNls) {
  // R 4.2.2: nls(y ~ a - b * x^(-c)), nls(y ~ a - b * exp(-c * x)), tol 1e-7: good to about 1e-7 of the errors.
  const auto p = fitLearningCurve(CurveShape::power, attempts, times);
  ASSERT_TRUE(p) << p.reason();
  EXPECT_NEAR(p->plateau, 46.64150667324263, 1e-6);
  EXPECT_NEAR(p->gap, -81.5457146562937, 1e-6);
  EXPECT_NEAR(p->rate, 0.69714495182802, 2e-8);
  EXPECT_NEAR(p->plateauError, 3.204629024551381, 1e-6);
  EXPECT_NEAR(p->gapError, 3.015832184954692, 1e-6);
  EXPECT_NEAR(*p->rateError, 0.061601035929543, 2e-8);
  EXPECT_NEAR(p->residualSumOfSquares, 17.525088984003215, 1e-10);
  EXPECT_NEAR(p->sigma, 1.395432588602434, 1e-11);
  const auto e = fitLearningCurve(CurveShape::exponential, attempts, times);
  ASSERT_TRUE(e) << e.reason();
  EXPECT_NEAR(e->plateau, 63.256961463967741, 1e-6);
  EXPECT_NEAR(e->gap, -105.909871630642385, 1e-5);
  EXPECT_NEAR(e->rate, 0.519386655368879, 1e-7);
  EXPECT_NEAR(e->plateauError, 1.2681685756017473, 1e-6);
  EXPECT_NEAR(e->gapError, 7.3226325934519938, 1e-5);
  EXPECT_NEAR(*e->rateError, 0.0499626528726408, 1e-7);
  EXPECT_NEAR(e->residualSumOfSquares, 63.0049879083551829, 1e-9);
}

TEST(LearningCurve, biochemicalOxygenDemand) {
  // R 4.2.2: nls(demand ~ a - b * exp(-c * Time), BOD) (Bates and Watts 1988, A1.4), six values at uneven places.
  const auto c =
      fitLearningCurve(CurveShape::exponential, Values{1, 2, 3, 4, 5, 7}, Values{8.3, 10.3, 19.0, 16.0, 15.6, 19.8});
  ASSERT_TRUE(c) << c.reason();
  EXPECT_NEAR(c->plateau, 19.161966531448591, 2e-5);
  EXPECT_NEAR(c->gap, 19.077735988028046, 2e-5);
  EXPECT_NEAR(c->rate, 0.527517850541661, 2e-6);
  EXPECT_NEAR(*c->rateError, 0.504890264291801, 2e-6);
  EXPECT_NEAR(c->residualSumOfSquares, 25.989763912247277, 1e-9);
}

TEST(LearningCurve, recoversExactCurvesToTheLastDigits) {
  for (const CurveShape shape : {CurveShape::power, CurveShape::exponential}) {
    for (const double rate : {0.15, 0.5, 1.3, 3.0}) {
      for (const double gap : {-40.0, 5.0}) {
        LearningCurve truth;
        truth.shape = shape;
        truth.plateau = 60.0;
        truth.gap = gap;
        truth.rate = rate;
        Values y;
        for (const double x : attempts) y.push_back(truth.at(x));
        const auto c = fitLearningCurve(shape, attempts, y);
        ASSERT_TRUE(c) << c.reason() << " rate " << rate;
        EXPECT_NEAR(c->plateau, 60.0, 1e-8);
        EXPECT_NEAR(c->gap, gap, 1e-7);
        EXPECT_NEAR(c->rate, rate, 1e-8);
        EXPECT_LT(c->residualSumOfSquares, 1e-20);
      }
    }
  }
}

TEST(LearningCurve, isAMinimum) {
  // No neighbour, whichever way, has a smaller sum of squares.
  const unsigned seed = 12;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  int fitted = 0;
  for (int round = 0; round < 60; ++round) {
    const CurveShape shape = round % 2 == 0 ? CurveShape::power : CurveShape::exponential;
    Values y;
    for (const double x : attempts) y.push_back(60.0 + 50.0 * std::exp(-0.4 * x) + 4.0 * normal(random));
    const auto c = fitLearningCurve(shape, attempts, y);
    if (!c) {
      EXPECT_NE(c.reason().find("does not converge"), std::string::npos) << c.reason();
      continue;
    }
    ++fitted;
    const auto sum = [&](const LearningCurve& curve) {
      double s = 0.0;
      for (std::size_t i = 0; i < y.size(); ++i) s += std::pow(y[i] - curve.at(attempts[i]), 2);
      return s;
    };
    EXPECT_NEAR(sum(*c), c->residualSumOfSquares, 1e-9 * c->residualSumOfSquares);
    for (double LearningCurve::*parameter : {&LearningCurve::plateau, &LearningCurve::gap, &LearningCurve::rate}) {
      for (const double factor : {0.999, 1.001}) {
        LearningCurve near = *c;
        near.*parameter *= factor;
        EXPECT_GE(sum(near), c->residualSumOfSquares);
      }
    }
  }
  EXPECT_GT(fitted, 30);
}

TEST(LearningCurve, refusals) {
  const auto reason = [](CurveShape s, const Values& x, const Values& y) { return fitLearningCurve(s, x, y).reason(); };
  Values line;
  for (const double x : attempts) line.push_back(100.0 - 3.0 * x);
  EXPECT_EQ(reason(CurveShape::exponential, attempts, line), "does not converge: no plateau in sight");
  Values once(12, 60.0);
  once[0] = 90.0;
  for (const CurveShape s : {CurveShape::power, CurveShape::exponential})
    EXPECT_EQ(reason(s, attempts, once), "does not converge: all change is over after the first attempt");
  EXPECT_EQ(reason(CurveShape::power, attempts, Values(12, 5.0)), "all values are equal");
  EXPECT_EQ(reason(CurveShape::power, {1, 2, 3}, {3, 2, 1}), "too few attempts for the curve");
  EXPECT_EQ(reason(CurveShape::power, {1, 1, 2, 2, 2}, {3, 2, 1, 2, 3}), "too few attempts for the curve");
  EXPECT_EQ(reason(CurveShape::inverse, {1, 1, 1}, {3, 2, 1}), "too few attempts for the curve");
  EXPECT_EQ(reason(CurveShape::inverse, {0, 1, 2}, {3, 2, 1}), "an attempt's number is not positive");
  EXPECT_EQ(reason(CurveShape::inverse, {1, 2}, {3, 2, 1}), "attempts and values have different lengths");
  EXPECT_EQ(reason(CurveShape::inverse, {1, 2, 3}, {3, 2, NAN}), "a value is not finite");
}

}  // namespace
}  // namespace calot::analytics

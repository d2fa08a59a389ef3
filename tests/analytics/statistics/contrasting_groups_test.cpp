// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/standard_setting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

/// A sample of `n` with exactly this mean and deviation.
Values sampleOf(double centre, double deviation, std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  Values v(n);
  for (double& x : v) x = static_cast<double>(random() % 100000) / 1000.0;
  const double m = *mean(v), s = *standardDeviation(v);
  for (double& x : v) x = centre + deviation * (x - m) / s;
  return v;
}

TEST(ContrastingGroups, crossingOfTwoNormals) {
  const auto cut = crossing({50, 10}, {70, 5});
  ASSERT_TRUE(cut) << cut.reason();
  EXPECT_NEAR(*cut, 61.7004517205, 5e-11);
  EXPECT_NEAR(*crossing({70, 5}, {50, 10}), *cut, 1e-12);
  // Root of the quadratic, worked out: x = (b + sqrt(b^2 - a c)) / a with a = 1/s1^2 - 1/s2^2 and so on.
  const double a = 1.0 / 100 - 1.0 / 25, b = 50.0 / 100 - 70.0 / 25,
               c = 2500.0 / 100 - 4900.0 / 25 - 2.0 * std::log(5.0 / 10.0);
  EXPECT_NEAR(*cut, (b + std::sqrt(b * b - a * c)) / a, 1e-10);
  EXPECT_NEAR(*crossing({50, 10}, {70, 10}), 60.0, 1e-12);
}

TEST(ContrastingGroups, sharesOfThePublishedExample) {
  // Experts N(70, 5), novices N(50, 10), higher is better: 12.1 % of the novices pass, 4.85 % of the experts fail.
  const Values experts = sampleOf(70, 5, 40, 1), novices = sampleOf(50, 10, 40, 2);
  ContrastingGroupsOptions options;
  options.resamples = 999;
  const auto g = contrastingGroups(experts, novices, Better::higher, options);
  ASSERT_TRUE(g) << g.reason();
  EXPECT_NEAR(g->cut, 61.7004517205, 5e-11);
  EXPECT_NEAR(g->falsePositives.theoretical, 0.120991395, 5e-10);
  EXPECT_NEAR(g->falseNegatives.theoretical, 0.0484663143, 5e-11);
  std::size_t pass = 0, fail = 0;
  for (const double v : novices) pass += v >= g->cut ? 1 : 0;
  for (const double v : experts) fail += v < g->cut ? 1 : 0;
  EXPECT_EQ(g->falsePositives.observed, pass);
  EXPECT_EQ(g->falseNegatives.observed, fail);
  EXPECT_DOUBLE_EQ(g->falsePositives.share, static_cast<double>(pass) / 40.0);
  ASSERT_TRUE(g->interval) << g->interval.reason();
  EXPECT_LT(g->interval->lower, g->cut);
  EXPECT_GT(g->interval->upper, g->cut);
}

TEST(ContrastingGroups, lowerIsBetterIsItsMirror) {
  const Values experts = sampleOf(70, 5, 12, 3), novices = sampleOf(50, 10, 12, 4);
  Values fast = experts, slow = novices;
  for (Values* group : {&fast, &slow}) {
    for (double& v : *group) v = 200.0 - v;
  }
  const auto up = contrastingGroups(experts, novices, Better::higher),
             down = contrastingGroups(fast, slow, Better::lower);
  ASSERT_TRUE(up && down);
  EXPECT_NEAR(down->cut, 200.0 - up->cut, 1e-9);
  EXPECT_EQ(down->falsePositives.observed, up->falsePositives.observed);
  EXPECT_NEAR(down->falsePositives.theoretical, up->falsePositives.theoretical, 1e-12);
  EXPECT_NEAR(down->falseNegatives.theoretical, up->falseNegatives.theoretical, 1e-12);
  EXPECT_NEAR(down->interval->lower, 200.0 - up->interval->upper, 1e-9);
}

TEST(ContrastingGroups, timesOnTheLogScale) {
  Values experts = sampleOf(4.0, 0.2, 15, 5), novices = sampleOf(5.0, 0.4, 15, 6);
  const double cut = *crossing({4.0, 0.2}, {5.0, 0.4});
  for (Values* group : {&experts, &novices}) {
    for (double& v : *group) v = std::exp(v);
  }
  ContrastingGroupsOptions options;
  options.logScale = true;
  const auto g = contrastingGroups(experts, novices, Better::lower, options);
  ASSERT_TRUE(g) << g.reason();
  EXPECT_NEAR(g->cut, std::exp(cut), 1e-9);
  EXPECT_GT(g->interval->lower, 0.0);
  novices[0] = 0.0;
  expectNames(contrastingGroups(experts, novices, Better::lower, options).reason(), {});
}

TEST(ContrastingGroups, refusals) {
  expectDistinct({crossing({50, 10}, {51, 1}).reason(), crossing({50, 10}, {50, 5}).reason(),
                  crossing({50, 0}, {60, 5}).reason(), crossing({NAN, 1}, {60, 5}).reason()});
  const Values a{1, 2, 3}, b{7, 8, 9}, wide{-30, 2, 36}, narrow{2.9, 3.0, 3.1};
  expectDistinct(
      {contrastingGroups(narrow, wide, Better::higher).reason(), contrastingGroups(a, b, Better::higher).reason(),
       contrastingGroups(Values{}, b, Better::higher).reason(), contrastingGroups(a, Values{}, Better::higher).reason(),
       contrastingGroups(b, Values{1.0}, Better::higher).reason(),
       contrastingGroups(b, Values{1.0, 1.0}, Better::higher).reason()});
  // Two against two: half of the resamples have a group without spread. There is a cut and no interval of it.
  const auto g = contrastingGroups(Values{7, 8}, Values{1, 2}, Better::higher);
  ASSERT_TRUE(g);
  expectNames(g->interval.reason(), {});
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
// Hedges' g and the distributions behind it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/two_groups.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using data::sleep1, data::sleep2;
using Values = std::vector<double>;

TEST(HedgesG, sleep) {
  const auto g = hedgesG(sleep1, sleep2);
  ASSERT_TRUE(g) << g.reason();
  EXPECT_NEAR(g->g, -0.7969352392, 5e-11);
  EXPECT_NEAR(g->j, 0.957646427, 5e-10);
  ASSERT_TRUE(g->interval) << g->interval.reason();
  EXPECT_NEAR(g->interval->lower, -1.665171791, 5e-10);
  EXPECT_NEAR(g->interval->upper, 0.0914077328, 5e-11);
  EXPECT_EQ(g->interval->method, "J times non-central t");
}

TEST(HedgesG, intervalEndsWhereNoncentralStudentSaysSo) {
  // Independent of the search: T = (Z + delta) / sqrt(chi^2 / m), simulated at the upper end, is below t in 2.5 %.
  const auto g = hedgesG(sleep1, sleep2);
  const double scale = std::sqrt(5.0), t = g->d * scale, delta = g->interval->upper / g->j * scale;
  const unsigned seed = 1908;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> chi(18.0);
  int below = 0;
  const int draws = 400000;
  for (int i = 0; i < draws; ++i) {
    const double z = normal(random);
    if ((z + delta) / std::sqrt(chi(random) / 18.0) <= t) ++below;
  }
  EXPECT_NEAR(below / static_cast<double>(draws), 0.025, 4.0 * std::sqrt(0.025 * 0.975 / draws));
}

TEST(HedgesG, turnsItsSignAndForgetsTheUnit) {
  const auto g = hedgesG(sleep1, sleep2), turned = hedgesG(sleep2, sleep1);
  EXPECT_DOUBLE_EQ(g->g, -turned->g);
  EXPECT_NEAR(g->interval->lower, -turned->interval->upper, 1e-10);
  Values x = sleep1, y = sleep2;
  for (Values* group : {&x, &y}) {
    for (double& v : *group) v = 60.0 * v + 1000.0;
  }
  EXPECT_NEAR(hedgesG(x, y)->g, g->g, 1e-12);
}

TEST(HedgesG, degenerate) {
  expectDistinct({hedgesG(Values{1}, Values{1, 2}).reason(), hedgesG(Values{1, 1}, Values{2, 2}).reason()});
  // Complete separation by a million deviations: g stands, the interval may not.
  const auto g = hedgesG(Values{0, 1e-6, 2e-6}, Values{1, 1 + 1e-6, 1 + 2e-6});
  ASSERT_TRUE(g);
  EXPECT_TRUE(std::isfinite(g->g));
  if (g->interval) {
    EXPECT_TRUE(std::isfinite(g->interval->lower) && std::isfinite(g->interval->upper));
    EXPECT_LE(g->interval->lower, g->g);
  } else {
    expectNames(g->interval.reason(), {});
  }
}

TEST(Distributions, knownQuantiles) {
  // R 4.2.2: qnorm(.975), qchisq(.95, 1), qt(.975, 5), qf(.95, 5, 15), uniroot(function(d) pt(2, 8, d) - .5, c(0, 5)).
  EXPECT_NEAR(normalQuantile(0.975), 1.959963984540054, 1e-15);
  EXPECT_NEAR(normalTwoSided(-1.959963984540054), 0.05, 1e-15);
  EXPECT_NEAR(chiSquaredUpper(3.841458820694124, 1.0), 0.05, 1e-15);
  EXPECT_NEAR(studentQuantile(0.975, 5.0), 2.570581835636314, 1e-14);
  EXPECT_NEAR(fisherQuantile(0.95, 5.0, 15.0), 2.901294536236158, 1e-13);
  EXPECT_NEAR(noncentralStudentParameter(2.0, 8.0, 0.5), 1.934301169194901, 1e-12);
}

}  // namespace
}  // namespace calot::analytics

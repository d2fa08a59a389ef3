// SPDX-License-Identifier: GPL-3.0-or-later
// Welch's test, Hedges' g, the permutation test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/hedges.h"
#include "analytics/statistics/permutation.h"
#include "analytics/statistics/welch.h"
#include "tests/analytics/statistics/support/published_data.h"

namespace calot::analytics {
namespace {

using data::sleep1, data::sleep2;
using Values = std::vector<double>;

TEST(Welch, sleep) {
  // R 4.2.2: t.test(sleep$extra[1:10], sleep$extra[11:20]).
  const auto w = welch(sleep1, sleep2);
  ASSERT_TRUE(w) << w.reason();
  EXPECT_NEAR(w->difference, -1.58, 1e-14);
  EXPECT_NEAR(w->t, -1.8608134674868531, 1e-14);
  EXPECT_NEAR(w->df, 17.7764735161784984, 1e-12);
  EXPECT_NEAR(w->p, 0.0793941401873582, 1e-14);
  EXPECT_NEAR(w->interval.lower, -3.3654832307117104, 1e-13);
  EXPECT_NEAR(w->interval.upper, 0.2054832307117102, 1e-13);
}

TEST(Welch, oneGroupWithoutSpreadIsAOneSampleTest) {
  // R 4.2.2: t.test(c(1, 2, 4), mu = 5): t = -3.0237157840738176, df = 2.
  const auto w = welch(Values{1, 2, 4}, Values{5, 5, 5});
  ASSERT_TRUE(w);
  EXPECT_NEAR(w->t, -3.0237157840738176, 1e-14);
  EXPECT_NEAR(w->df, 2.0, 1e-14);
}

TEST(Welch, degenerate) {
  EXPECT_EQ(welch(Values{1}, Values{1, 2}).reason(), "a group of one value has no spread");
  EXPECT_EQ(welch(Values{}, Values{1, 2}).reason(), "the first group is empty");
  EXPECT_EQ(welch(Values{3, 3}, Values{4, 4}).reason(), "no spread within the groups");
  EXPECT_EQ(welch(Values{3, NAN}, Values{4, 4}).reason(), "a value is not finite");
}

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
  EXPECT_EQ(hedgesG(Values{1}, Values{1, 2}).reason(), "a group of one value has no spread");
  EXPECT_EQ(hedgesG(Values{1, 1}, Values{2, 2}).reason(), "no spread within the groups");
  // Complete separation by a million deviations: g stands, the interval may not.
  const auto g = hedgesG(Values{0, 1e-6, 2e-6}, Values{1, 1 + 1e-6, 1 + 2e-6});
  ASSERT_TRUE(g);
  EXPECT_TRUE(std::isfinite(g->g));
  if (g->interval) {
    EXPECT_TRUE(std::isfinite(g->interval->lower) && std::isfinite(g->interval->upper));
    EXPECT_LE(g->interval->lower, g->g);
  } else {
    EXPECT_NE(g->interval.reason().find("too large"), std::string::npos);
  }
}

TEST(PermutationTest, allAssignments) {
  // R 4.2.2: s <- colSums(matrix(v[combn(20, 10)], 10)); mean(abs(s - sum(v) / 2) >= abs(sum(v[1:10]) - sum(v) / 2) -
  // 1e-9).
  const auto p = permutationTest(sleep1, sleep2);
  ASSERT_TRUE(p) << p.reason();
  EXPECT_TRUE(p->exact);
  EXPECT_EQ(p->assignments, 184756U);
  EXPECT_FALSE(p->seed);
  EXPECT_NEAR(p->p, 0.081447963800905, 5e-16);
  EXPECT_NEAR(permutationTest(Values{19, 22, 16, 29, 24}, Values{20, 11, 17, 12})->p, 9.0 / 126.0, 1e-15);
}

TEST(PermutationTest, randomAssignmentsAgreeAndNameTheirSeed) {
  PermutationOptions options;
  options.maxAssignments = 1000;
  options.seed = 77;
  const auto p = permutationTest(sleep1, sleep2, options);
  EXPECT_FALSE(p->exact);
  EXPECT_EQ(p->seed, 77U);
  EXPECT_EQ(p->assignments, 99999U);
  EXPECT_NEAR(p->p, 0.081447963800905, 4.0 * std::sqrt(0.0814 * 0.9186 / 99999.0));
  EXPECT_DOUBLE_EQ(permutationTest(sleep1, sleep2, options)->p, p->p);
  // Never zero: 1 / (draws + 1) is the least.
  Values x(30), y(30);
  for (std::size_t i = 0; i < 30; ++i) x[i] = static_cast<double>(i), y[i] = 1000.0 + static_cast<double>(i);
  options.draws = 999;
  EXPECT_DOUBLE_EQ(permutationTest(x, y, options)->p, 0.001);
}

TEST(PermutationTest, degenerateAndScaled) {
  EXPECT_EQ(permutationTest(Values{2, 2}, Values{2}).reason(), "all values are equal");
  EXPECT_EQ(permutationTest(Values{}, Values{2}).reason(), "the first group is empty");
  // Sums that are equal but for rounding count as equal: tenths have no exact binary value.
  Values x{0.1, 0.2, 0.3}, y{0.4, 0.5, 0.6};
  EXPECT_DOUBLE_EQ(permutationTest(x, y)->p, 0.1);
  EXPECT_DOUBLE_EQ(permutationTest(Values{0.1, 0.5, 0.6}, Values{0.2, 0.3, 0.4})->p,
                   permutationTest(Values{1, 5, 6}, Values{2, 3, 4})->p);
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

// SPDX-License-Identifier: GPL-3.0-or-later
// Published examples (values of R 4.2.2), brute force over all assignments, and the laws that the statistics obey.
#include "analytics/statistics/two_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

// R, ?wilcox.test: permeability constants of the human chorioamnion (Hollander and Wolfe 1973, p. 69).
const Values term{0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
const Values early{1.15, 0.88, 0.90, 0.74, 1.21};

using data::sleep1, data::sleep2;

/// Share of the subsets of the pooled values as large as `x` whose U is at least that of x.
double bruteForceGreater(const Values& x, const Values& y) {
  Values pooled = x;
  pooled.insert(pooled.end(), y.begin(), y.end());
  const double observed = mannWhitney(x, y)->u;
  std::vector<bool> chosen(pooled.size(), false);
  std::fill(chosen.end() - static_cast<std::ptrdiff_t>(x.size()), chosen.end(), true);
  double all = 0.0, far = 0.0;
  do {
    double u = 0.0;
    for (std::size_t i = 0; i < pooled.size(); ++i) {
      for (std::size_t j = 0; j < pooled.size(); ++j) {
        if (chosen[i] && !chosen[j]) u += pooled[i] > pooled[j] ? 1.0 : pooled[i] == pooled[j] ? 0.5 : 0.0;
      }
    }
    all += 1.0;
    far += u >= observed ? 1.0 : 0.0;
  } while (std::next_permutation(chosen.begin(), chosen.end()));
  return far / all;
}

/// Two-sided p by going through every subset of the pooled mid-ranks.
double bruteForceP(const Values& x, const Values& y) {
  Values pooled = x;
  pooled.insert(pooled.end(), y.begin(), y.end());
  const Values ranks = midRanks(pooled);
  double observed = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) observed += ranks[i];
  const double expected = static_cast<double>(x.size() * (pooled.size() + 1)) / 2.0;
  long hits = 0, all = 0;
  for (unsigned subset = 0; subset < (1U << pooled.size()); ++subset) {
    if (static_cast<std::size_t>(std::popcount(subset)) != x.size()) continue;
    double sum = 0.0;
    for (std::size_t i = 0; i < pooled.size(); ++i) sum += (subset >> i & 1U) != 0 ? ranks[i] : 0.0;
    ++all;
    hits += std::abs(sum - expected) >= std::abs(observed - expected) ? 1 : 0;
  }
  return static_cast<double>(hits) / static_cast<double>(all);
}

TEST(MannWhitney, permeabilityExample) {
  const auto test = mannWhitney(term, early);
  ASSERT_TRUE(test) << test.reason();
  EXPECT_DOUBLE_EQ(test->u, 35.0);
  EXPECT_TRUE(test->exact);
  EXPECT_FALSE(test->ties);
  EXPECT_NEAR(test->p, 0.254412254412, 5e-13);
  EXPECT_NEAR(*hodgesLehmann(term, early), 0.305, 1e-12);
  const auto interval = hodgesLehmannInterval(term, early);
  ASSERT_TRUE(interval) << interval.reason();
  EXPECT_NEAR(interval->lower, -0.15, 1e-12);
  EXPECT_NEAR(interval->upper, 0.76, 1e-12);
  EXPECT_GE(interval->attained, 0.95);
  EXPECT_LT(interval->attained, 0.98);
}

TEST(MannWhitney, oneSidedIsRsGreater) {
  EXPECT_NEAR(mannWhitney(term, early)->greater, 382.0 / 3003.0, 1e-12);  // R: 0.1272
  EXPECT_NEAR(mannWhitney(early, term)->greater, bruteForceGreater(early, term), 1e-12);
  EXPECT_NEAR(mannWhitney(sleep2, sleep1)->greater, bruteForceGreater(sleep2, sleep1), 1e-12) << "ties";
}

/// Groups that differ by exactly the margin: the claim is false, and is found in at most 5 %; groups that do not differ
/// are found alike.
TEST(MarginTest, holdsItsLevelAndFindsWhatIsAlike) {
  std::mt19937 random(43);
  std::normal_distribution<double> normal;
  for (const std::size_t n : {6U, 12U}) {
    std::size_t atTheMargin = 0, alike = 0;
    constexpr std::size_t studies = 4000;
    for (std::size_t s = 0; s < studies; ++s) {
      Values x(n), y(n);
      for (double& v : x) v = normal(random);
      for (double& v : y) v = normal(random);
      Values further = x;
      for (double& v : further) v += 2.0;
      atTheMargin += *marginTest(further, y, 2.0, true) <= 0.05 ? 1 : 0;
      alike += *marginTest(x, y, 2.0, true) <= 0.05 ? 1 : 0;
    }
    EXPECT_LE(atTheMargin, 0.06 * studies) << n;
    EXPECT_GE(atTheMargin, 0.02 * studies) << n;
    EXPECT_GE(alike, 0.7 * studies) << n;
  }
}

TEST(MannWhitney, smallExampleExactAndAsymptotic) {
  const Values x{19, 22, 16, 29, 24}, y{20, 11, 17, 12};
  const auto exact = mannWhitney(x, y);
  EXPECT_DOUBLE_EQ(exact->u, 17.0);
  EXPECT_NEAR(exact->p, 0.111111, 5e-7);
  EXPECT_NEAR(exact->p, 1.0 / 9.0, 1e-15);
  const auto asymptotic = mannWhitney(x, y, RankTest::asymptotic);
  EXPECT_FALSE(asymptotic->exact);
  EXPECT_NEAR(asymptotic->p, 0.111346886533, 5e-13);
}

TEST(MannWhitney, completeSeparationOfTenAndTen) {
  Values x, y;
  for (int i = 0; i < 10; ++i) {
    x.push_back(i);
    y.push_back(100 + i);
  }
  EXPECT_DOUBLE_EQ(mannWhitney(x, y)->u, 0.0);
  EXPECT_NEAR(mannWhitney(x, y)->p, 1.082508822e-5, 5e-15);
  EXPECT_DOUBLE_EQ(mannWhitney(y, x)->u, 100.0);
  EXPECT_DOUBLE_EQ(superiority(x, y)->delta, -1.0);
  EXPECT_DOUBLE_EQ(superiority(y, x)->a, 1.0);
}

TEST(MannWhitney, tenAndTenAroundFivePercent) {
  // Moves y's lowest values below x's: each step of one rank adds one to U.
  const auto withU = [](int u) {
    Values x, y;
    for (int i = 0; i < 10; ++i) x.push_back(i), y.push_back(100 + i);
    const int full = u / 10, rest = u % 10;
    for (int i = 0; i < full; ++i) y[static_cast<std::size_t>(i)] = -10.0 + i;
    if (rest > 0) y[static_cast<std::size_t>(full)] = 9.5 - rest;
    return mannWhitney(x, y);
  };
  EXPECT_DOUBLE_EQ(withU(23)->u, 23.0);
  EXPECT_NEAR(withU(23)->p, 0.0432570525, 5e-11);
  EXPECT_DOUBLE_EQ(withU(24)->u, 24.0);
  EXPECT_NEAR(withU(24)->p, 0.0524259023, 5e-11);
}

TEST(MannWhitney, sleepHasTies) {
  const auto exact = mannWhitney(sleep1, sleep2);
  EXPECT_DOUBLE_EQ(exact->u, 25.5);
  EXPECT_TRUE(exact->ties);
  EXPECT_TRUE(exact->exact);
  EXPECT_NEAR(exact->p, 0.0658165364, 5e-11);
  EXPECT_NEAR(mannWhitney(sleep1, sleep2, RankTest::asymptotic)->p, 0.0693275754, 5e-11);
  const auto effect = superiority(sleep1, sleep2);
  EXPECT_NEAR(effect->delta, -0.49, 1e-15);
  EXPECT_NEAR(effect->a, 0.255, 1e-15);
  // R: d <- sort(outer(x, y, "-")); q <- qwilcox(.025, 10, 10); d[q], d[101 - q], 1 - 2 * pwilcox(q - 1, 10, 10).
  const auto interval = hodgesLehmannInterval(sleep1, sleep2);
  ASSERT_TRUE(interval) << interval.reason();
  EXPECT_NEAR(interval->lower, -3.6, 1e-14);
  EXPECT_NEAR(interval->upper, 0.1, 1e-14);
  EXPECT_NEAR(interval->attained, 0.956742947455022, 5e-15);
  EXPECT_EQ(interval->method, ShiftMethod::conservative);
}

TEST(MannWhitney, exactEqualsEnumerationWithAndWithoutTies) {
  const unsigned seed = 20140517;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    const std::size_t nx = 1 + random() % 7, ny = 1 + random() % 7;
    const unsigned levels = round % 2 == 0 ? 4 : 1000000;
    Values x, y;
    for (std::size_t i = 0; i < nx; ++i) x.push_back(static_cast<double>(random() % levels));
    for (std::size_t i = 0; i < ny; ++i) y.push_back(static_cast<double>(random() % levels));
    const auto test = mannWhitney(x, y, RankTest::exact);
    if (!test) {
      expectNames(test.reason(), {});
      continue;
    }
    EXPECT_NEAR(test->p, bruteForceP(x, y), 1e-13);
  }
}

TEST(MannWhitney, obeysItsSymmetries) {
  const unsigned seed = 944;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 40; ++round) {
    Values x(2 + random() % 20), y(2 + random() % 20);
    for (double& v : x) v = static_cast<double>(random() % 50);
    for (double& v : y) v = static_cast<double>(random() % 50 + 5);
    const auto xy = mannWhitney(x, y), yx = mannWhitney(y, x);
    ASSERT_TRUE(xy && yx);
    EXPECT_DOUBLE_EQ(xy->u + yx->u, static_cast<double>(x.size() * y.size()));
    EXPECT_NEAR(xy->p, yx->p, 1e-12);
    EXPECT_NEAR(superiority(x, y)->delta, -superiority(y, x)->delta, 1e-15);
    EXPECT_DOUBLE_EQ(*hodgesLehmann(x, y), -*hodgesLehmann(y, x));
    // A rank test sees ranks only: any increasing map leaves it alone.
    Values cubedX = x, cubedY = y;
    for (double& v : cubedX) v = v * v * v + 1.0;
    for (double& v : cubedY) v = v * v * v + 1.0;
    EXPECT_EQ(mannWhitney(cubedX, cubedY)->p, xy->p);
    // The shift follows a shift.
    Values moved = x;
    for (double& v : moved) v += 8.0;
    EXPECT_DOUBLE_EQ(*hodgesLehmann(moved, y), *hodgesLehmann(x, y) + 8.0);
  }
}

TEST(MannWhitney, asymptoticMeetsExactWhereTheMethodChanges) {
  std::mt19937 random(7);
  Values x(40), y(40);
  for (double& v : x) v = static_cast<double>(random() % 100000);
  for (double& v : y) v = static_cast<double>(random() % 100000) + 15000.0;
  const auto automatic = mannWhitney(x, y);
  EXPECT_TRUE(automatic->exact);
  EXPECT_NEAR(automatic->p, mannWhitney(x, y, RankTest::asymptotic)->p, 0.003);
  x.push_back(50.5);
  EXPECT_FALSE(mannWhitney(x, y)->exact);
}

TEST(MannWhitney, degenerateInputAnswersWithAReason) {
  const Values none, one{1.0}, same{2.0, 2.0, 2.0}, bad{1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(superiority(none, same).reason(), mannWhitney(none, same).reason());
  EXPECT_EQ(hodgesLehmann(same, none).reason(), mannWhitney(same, none).reason());
  EXPECT_EQ(hodgesLehmannInterval(same, same).reason(), mannWhitney(same, same).reason());
  expectDistinct({mannWhitney(none, same).reason(), mannWhitney(same, none).reason(), mannWhitney(none, none).reason(),
                  mannWhitney(same, same).reason(), mannWhitney(bad, same).reason(),
                  hodgesLehmannInterval(one, Values{2.0, 3.0}).reason()});
  // One against one is a legal, uninformative test.
  EXPECT_DOUBLE_EQ(mannWhitney(one, Values{2.0})->p, 1.0);
  EXPECT_DOUBLE_EQ(superiority(same, same)->delta, 0.0);
}

/// Median and ends of the interval are differences of the enumeration, to the last bit: with and without ties, of any
/// sign.
TEST(HodgesLehmann, isTheMedianOfAllDifferences) {
  const unsigned seed = 11;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 300; ++round) {
    const int nx = 1 + static_cast<int>(random() % 60), ny = 1 + static_cast<int>(random() % 60);
    const double step = round % 3 == 0 ? 1.0 : 1e-3 * static_cast<double>(1 + random() % 1000);
    Values x, y, all;
    for (int i = 0; i < nx; ++i) x.push_back(step * (static_cast<double>(random() % 41) - 20.0));
    for (int i = 0; i < ny; ++i)
      y.push_back(step * (static_cast<double>(random() % 41) - (round % 2 == 0 ? 20.0 : 45.0)));
    for (const double a : x) {
      for (const double b : y) all.push_back(a - b);
    }
    std::sort(all.begin(), all.end());
    const double upper = all[all.size() / 2], lower = all[(all.size() - 1) / 2];
    EXPECT_EQ(*hodgesLehmann(x, y), all.size() % 2 == 1 ? upper : lower + 0.5 * (upper - lower));
    // The ends are order statistics as far from either end: some rank u has both.
    if (const auto interval = hodgesLehmannInterval(x, y)) {
      bool found = false;
      for (std::size_t u = 0; 2 * u < all.size(); ++u)
        found = found || (all[u] == interval->lower && all[all.size() - 1 - u] == interval->upper);
      EXPECT_TRUE(found);
    }
  }
  EXPECT_FALSE(std::signbit(*hodgesLehmann(Values{1.0}, Values{1.0})));
  // As many as a cohort may hold: 25 million differences that nobody makes.
  Values many(5000), others(5000);
  for (std::size_t i = 0; i < many.size(); ++i) {
    many[i] = static_cast<double>(i);
    others[i] = static_cast<double>(i) + 0.25;
  }
  EXPECT_EQ(*hodgesLehmann(many, others), -0.25);
}

TEST(HodgesLehmannInterval, attainedLevelIsThatOfTheEnumeration) {
  // 5 v 4: U's quantile at 2.5 % is 2 (P(U <= 1) = 2/126), so the attained level is 1 - 4/126.
  const Values x{19, 22, 16, 29, 24}, y{20, 11, 17, 12};
  const auto interval = hodgesLehmannInterval(x, y);
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->attained, 1.0 - 4.0 / 126.0, 1e-14);
}

/// Counted in whole numbers of any size by the generating function, the product of (1 - q^(ny + i)) / (1 - q^i) over i
/// from 1 to nx.
TEST(RankSumQuantile, isThatOfTheGeneratingFunction) {
  const struct {
    std::size_t nx, ny, u;
    double below;
  } cases[] = {{10, 10, 24, 0.02162852627248912},
               {41, 40, 613, 0.0248076888990636},
               {90, 60, 2190, 0.02498880397639896},
               {20, 280, 2067, 0.024920249195548142},
               {150, 150, 9778, 0.02494527502999322}};
  for (const auto& c : cases) {
    const RankSumQuantile quantile = rankSumQuantile(c.nx, c.ny, 0.025);
    EXPECT_EQ(quantile.u, c.u) << c.nx << " and " << c.ny;
    EXPECT_NEAR(quantile.below, c.below, 1e-13) << c.nx << " and " << c.ny;
  }
  // One against one: U is 0 or 1, each half the time.
  EXPECT_EQ(rankSumQuantile(1, 1, 0.025).u, 0U);
  EXPECT_DOUBLE_EQ(rankSumQuantile(1, 1, 0.025).below, 0.0);
}

TEST(HodgesLehmannInterval, beyondItsLimitTheNormalQuantileOfU) {
  // x_i - y_j are all different: the k-th of them in order tells the rank that was taken.
  Values x(160), y(150), all;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(1000 * i);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = static_cast<double>(i) + 0.5;
  for (const double a : x) {
    for (const double b : y) all.push_back(a - b);
  }
  std::sort(all.begin(), all.end());
  const auto interval = hodgesLehmannInterval(x, y);
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->method, ShiftMethod::asymptotic);
  // 12000 - 1.959963984540054 sqrt(160 * 150 * 311 / 12)
  EXPECT_DOUBLE_EQ(interval->lower, all[10454 - 1]);
  EXPECT_DOUBLE_EQ(interval->upper, all[all.size() - 10454]);
  x.resize(150);
  EXPECT_EQ(hodgesLehmannInterval(x, y)->method, ShiftMethod::exact);
}

TEST(MannWhitney, smallestPIsThatOfTheFarthestAssignment) {
  EXPECT_NEAR(smallestRankTestP(3, 3), 0.1, 1e-15);
  EXPECT_NEAR(smallestRankTestP(4, 4), 2.0 / 70.0, 1e-15);
  EXPECT_NEAR(smallestRankTestP(5, 4), 2.0 / 126.0, 1e-15);
  EXPECT_DOUBLE_EQ(smallestRankTestP(1, 1), 1.0);
  // 2 / C(10, 5) = .0079, 2 / C(12, 6) = .0022.
  EXPECT_EQ(leastGroups(0.05), 4U);
  EXPECT_EQ(leastGroups(0.05 / 8.0), 6U);
  EXPECT_EQ(leastGroups(2.0 / 252.0 + 1e-15), 5U);
  EXPECT_EQ(leastGroups(1.0), 1U);
  const unsigned seed = 23;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    const std::size_t nx = 1 + random() % 5, ny = 1 + random() % 5;
    Values all(nx + ny);
    for (double& v : all) v = static_cast<double>(random() % (round % 2 == 0 ? 3 : 1000000));
    for (const RankTest method : {RankTest::exact, RankTest::asymptotic}) {
      const auto test = mannWhitney(Values(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(nx)),
                                    Values(all.begin() + static_cast<std::ptrdiff_t>(nx), all.end()), method);
      if (!test) continue;
      // Every choice of nx of the values, as bits.
      double least = 1.0;
      for (unsigned bits = 0; bits < 1U << all.size(); ++bits) {
        if (static_cast<std::size_t>(std::popcount(bits)) != nx) continue;
        Values x, y;
        for (std::size_t i = 0; i < all.size(); ++i) ((bits >> i & 1U) != 0 ? x : y).push_back(all[i]);
        least = std::min(least, mannWhitney(x, y, method)->p);
      }
      EXPECT_NEAR(test->smallestP, least, 1e-12);
    }
  }
}

TEST(HodgesLehmannInterval, isExactBeyondTheSizesOfTheExactTest) {
  // R: 41 and 72 values of aSAH's s100b; d <- sort(outer(x, y, "-")); d[u] .06 and d[41 * 72 + 1 - u] .25 at u 1148,
  // the quantile by the generating function (above); median(d) .16.
  const auto interval = hodgesLehmannInterval(data::s100bPoor, data::s100bGood);
  ASSERT_TRUE(interval) << interval.reason();
  EXPECT_EQ(interval->method, ShiftMethod::conservative);
  EXPECT_NEAR(interval->attained, 0.950485055928, 5e-12);
  EXPECT_NEAR(interval->lower, 0.06, 1e-14);
  EXPECT_NEAR(interval->upper, 0.25, 1e-14);
  EXPECT_NEAR(*hodgesLehmann(data::s100bPoor, data::s100bGood), 0.16, 1e-14);
  // wilcox.test(x, y): W 2159, p 4.50920257632946e-05.
  const auto test = mannWhitney(data::s100bPoor, data::s100bGood);
  EXPECT_FALSE(test->exact);
  EXPECT_DOUBLE_EQ(test->u, 2159.0);
  EXPECT_NEAR(test->p, 4.50920257632946e-05, 5e-18);
}

}  // namespace
}  // namespace calot::analytics

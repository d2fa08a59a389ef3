// SPDX-License-Identifier: GPL-3.0-or-later
// Spearman, Kruskal-Wallis, Dunn, and the stratified rank sum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/two_groups.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;
using Groups = std::vector<Values>;

TEST(Spearman, hollanderAndWolfesTuna) {
  // R 4.2.2, ?cor.test: cor.test(x, y, method = "spearman"), Hunter L values of canned tuna.
  const Values x{44.4, 45.9, 41.9, 53.3, 44.7, 44.1, 50.7, 45.2, 60.1};
  const Values y{2.6, 3.1, 2.5, 5.0, 3.6, 4.0, 5.2, 2.8, 3.8};
  const auto s = spearman(x, y);
  ASSERT_TRUE(s) << s.reason();
  EXPECT_NEAR(s->rho, 0.6, 1e-15);
  EXPECT_TRUE(s->exact);
  EXPECT_NEAR(s->p, 0.0967978395061728, 5e-16);
}

TEST(Spearman, tiesAndMorePairsByStudent) {
  // R 4.2.2: cor.test(mtcars$mpg, mtcars$wt, method = "spearman", exact = FALSE).
  const auto s = spearman(data::mpg, data::weight);
  EXPECT_FALSE(s->exact);
  EXPECT_TRUE(s->ties);
  EXPECT_NEAR(s->rho, -0.886422033270298, 5e-15);
  EXPECT_NEAR(s->p, 1.48759485812743e-11, 5e-24);
}

TEST(Spearman, degenerate) {
  expectDistinct({spearman(Values{1, 2}, Values{1, 2}).reason(), spearman(Values{1, 2, 3}, Values{1, 2}).reason(),
                  spearman(Values{1, 2, 3}, Values{1, 1, 1}).reason(),
                  spearman(Values{1, 2, INFINITY}, Values{1, 2, 3}).reason()});
  // Perfect order: two of n! orders, at nine by counting and at ten by the bound.
  Values nine(9), ten(10);
  std::iota(nine.begin(), nine.end(), 0.0);
  std::iota(ten.begin(), ten.end(), 0.0);
  EXPECT_DOUBLE_EQ(spearman(nine, nine)->p, 2.0 / 362880.0);
  EXPECT_NEAR(spearman(ten, ten)->p, 2.0 / 3628800.0, 1e-18);
  EXPECT_DOUBLE_EQ(spearman(ten, ten)->rho, 1.0);
  ten[9] = 8;  // one tie: both variables keep it in two orders
  EXPECT_NEAR(spearman(ten, ten)->p, 4.0 / 3628800.0, 1e-18);
}

/// Pain scores of Brunner and Munzel (2000), as in R's packages and in SciPy.
const Values painX{1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 2, 4, 1, 1}, painY{3, 3, 4, 3, 1, 2, 3, 1, 1, 5, 4};

TEST(BrunnerMunzel, painScoresOfScipyAndR) {
  // scipy.stats.brunnermunzel(x, y); df of R's lawstat; brunnermunzel::brunnermunzel.permutation.test(x, y) says
  // .008038: 35,827 of the 4,457,400 assignments.
  const auto t = brunnerMunzel(painX, painY, RankTest::asymptotic);
  ASSERT_TRUE(t) << t.reason();
  EXPECT_NEAR(t->statistic, -3.1374674823029505, 1e-14);
  EXPECT_NEAR(t->df, 17.682841979481545, 1e-12);
  EXPECT_NEAR(t->p, 0.005786208666151538, 1e-14);
  EXPECT_FALSE(t->exact);
  const auto all = brunnerMunzel(painX, painY, RankTest::exact);
  EXPECT_NEAR(all->p, 35827.0 / 4457400.0, 1e-15);
  const auto drawn = brunnerMunzel(painX, painY);
  EXPECT_TRUE(drawn->exact);
  EXPECT_NEAR(drawn->p, all->p, 4.0 * std::sqrt(all->p / 9999.0));
  EXPECT_DOUBLE_EQ(brunnerMunzel(painX, painY)->p, drawn->p) << "a seed of its own";
}

TEST(BrunnerMunzel, assignmentsAndSymmetry) {
  const Values x{3, 4, 4, 7.5}, y{1, 2, 4, 2, 9};
  const auto t = brunnerMunzel(x, y, RankTest::exact), turned = brunnerMunzel(y, x, RankTest::exact);
  EXPECT_NEAR(t->p, 43.0 / 126.0, 1e-15);
  EXPECT_DOUBLE_EQ(brunnerMunzel(x, y)->p, brunnerMunzel(x, y, RankTest::asymptotic)->p) << "the larger of both";
  EXPECT_DOUBLE_EQ(turned->statistic, -t->statistic);
  EXPECT_DOUBLE_EQ(turned->p, t->p);
  const auto apart = brunnerMunzel(Values{1, 2, 3, 4}, Values{5, 6, 7, 8, 9});
  EXPECT_NEAR(apart->p, 2.0 / 126.0, 1e-15);
  EXPECT_EQ(apart->statistic, -HUGE_VAL);
}

TEST(BrunnerMunzel, degenerate) {
  const auto reason = [](const Values& x, const Values& y, RankTest method = RankTest::automatic) {
    return brunnerMunzel(x, y, method).reason();
  };
  expectDistinct({reason({}, {1, 2}), reason({1, 2}, {1}), reason({1, 1}, {1, 1}), reason({1, NAN}, {1, 2}),
                  reason({1, 2}, {3, 4}, RankTest::asymptotic)});
}

TEST(KruskalWallis, examplesOfR) {
  // R 4.2.2: kruskal.test(Ozone ~ Month, airquality); kruskal.test(weight ~ group, PlantGrowth); ?kruskal.test's
  // mucociliary efficiency (Hollander and Wolfe 1973).
  const Groups ozone{data::ozone5, data::ozone6, data::ozone7, data::ozone8, data::ozone9};
  const auto months = kruskalWallis(ozone);
  ASSERT_TRUE(months) << months.reason();
  EXPECT_NEAR(months->h, 29.2665763061169, 5e-13);
  EXPECT_DOUBLE_EQ(months->df, 4.0);
  EXPECT_NEAR(months->p, 6.90071411854678e-06, 5e-19);
  const Groups plants{data::plantControl, data::plantOne, data::plantTwo};
  EXPECT_NEAR(kruskalWallis(plants)->h, 7.988228749443715, 5e-14);
  EXPECT_NEAR(kruskalWallis(plants)->p, 0.018423755731472, 5e-16);
  const Groups dust{{2.9, 3.0, 2.5, 2.6, 3.2}, {3.8, 2.7, 4.0, 2.4}, {2.8, 3.4, 3.7, 2.2, 2.0}};
  EXPECT_NEAR(kruskalWallis(dust)->h, 0.771428571428572, 5e-15);
  EXPECT_NEAR(kruskalWallis(dust)->p, 0.679964773578894, 5e-15);
}

TEST(KruskalWallis, dunnsPairs) {
  // R 4.2.2, base functions: z of the mean ranks as in the header, 2 * pnorm(-abs(z)), p.adjust(p, "holm").
  const auto plants = dunn(Groups{data::plantControl, data::plantOne, data::plantTwo});
  ASSERT_TRUE(plants) << plants.reason();
  const Values z{1.11772545437879, -1.68928960718612, -2.80701506156491};
  const Values p{0.2636842678913860, 0.0911639440484998, 0.0050002903702577};
  const Values adjusted{0.2636842678913860, 0.1823278880969997, 0.0150008711107731};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR((*plants)[i].z, z[i], 1e-13);
    EXPECT_NEAR((*plants)[i].p, p[i], 1e-14);
    EXPECT_NEAR((*plants)[i].adjusted, adjusted[i], 1e-14);
  }
  EXPECT_EQ((*plants)[2].first, 1U);
  EXPECT_EQ((*plants)[2].second, 2U);
  const auto months = dunn(Groups{data::ozone5, data::ozone6, data::ozone7, data::ozone8, data::ozone9});
  EXPECT_EQ(months->size(), 10U);
  EXPECT_NEAR((*months)[1].z, -4.41947064061155626, 1e-13);
  EXPECT_NEAR((*months)[1].adjusted, 9.89429615000046e-05, 1e-17);
  EXPECT_NEAR((*months)[9].z, 2.9228277777795233, 1e-13);
  EXPECT_NEAR((*months)[9].adjusted, 2.42807821280457e-02, 1e-15);
}

TEST(KruskalWallis, ofTwoGroupsIsTheRankSumTest) {
  // H = z^2 of Mann-Whitney without continuity correction, ties included; and Dunn's z is that z.
  const Groups two{data::sleep1, data::sleep2};
  const double h = kruskalWallis(two)->h;
  const double z = (*dunn(two))[0].z;
  EXPECT_NEAR(h, z * z, 1e-12);
  const std::vector<Stratum> one{{data::sleep1, data::sleep2}};
  EXPECT_NEAR(stratifiedRankSum(one)->z, z, 1e-12);
}

TEST(KruskalWallis, degenerate) {
  expectDistinct({kruskalWallis(Groups{{1, 2}}).reason(), kruskalWallis(Groups{{1, 2}, {}}).reason(),
                  dunn(Groups{{1, 1}, {1}}).reason(), dunn(Groups{{1, NAN}, {1}}).reason()});
}

TEST(StratifiedRankSum, varianceIsThatOfAllAssignmentsWithinStrata) {
  const std::vector<Stratum> strata{{{3, 5, 5}, {1, 5}}, {{10, 12}, {9, 10, 11, 10}}};
  // z of every assignment within strata has mean 0 and variance 1, by definition of the variance.
  const auto choose = [](const Stratum& s, auto&& visit) {
    Values all = s.x;
    all.insert(all.end(), s.y.begin(), s.y.end());
    for (unsigned set = 0; set < (1U << all.size()); ++set) {
      Stratum moved;
      for (std::size_t i = 0; i < all.size(); ++i) ((set >> i & 1U) != 0 ? moved.x : moved.y).push_back(all[i]);
      if (moved.x.size() == s.x.size()) visit(moved);
    }
  };
  double sum = 0.0, squares = 0.0;
  int count = 0;
  choose(strata[0], [&](const Stratum& a) {
    choose(strata[1], [&](const Stratum& b) {
      const double z = stratifiedRankSum(std::vector<Stratum>{a, b})->z;
      sum += z;
      squares += z * z;
      ++count;
    });
  });
  EXPECT_EQ(count, 10 * 15);
  EXPECT_NEAR(sum / count, 0.0, 1e-12);
  EXPECT_NEAR(squares / count, 1.0, 1e-12);
}

TEST(StratifiedRankSum, weighsSitesBySize) {
  // R 4.2.2, base functions: part <- function(x, y) { r <- rank(c(x, y)); n <- length(r); m <- length(x); c(sum(r[1:m])
  // - m * (n + 1) / 2, m * length(y) / (n * (n - 1)) * sum((r - mean(r))^2), n) }; sums of both sites' first over n +
  // 1, second over (n + 1)^2.
  const std::vector<Stratum> strata{{{31, 28, 40}, {35, 44, 39, 52}}, {{12, 15, 15, 19, 11}, {15, 18, 22, 19, 25, 30}}};
  const auto s = stratifiedRankSum(strata);
  ASSERT_TRUE(s) << s.reason();
  EXPECT_NEAR(s->z, -2.54404052070509179, 1e-14);
  EXPECT_NEAR(s->p, 0.01095783720752154, 1e-16);
}

TEST(StratifiedRankSum, seesThroughASiteThatIsSlowerAltogether) {
  // Within each site x is larger; pooled, the sites' difference hides it.
  std::vector<Stratum> strata{{{4, 5, 6}, {1, 2, 3}}, {{104, 105, 106, 107}, {101, 102, 103}}};
  const auto s = stratifiedRankSum(strata);
  EXPECT_DOUBLE_EQ(s->a, 1.0);
  EXPECT_LT(s->p, 0.01);
  EXPECT_EQ(s->strata, 2U);
  strata.push_back({{1, 2}, {}});
  strata.push_back({{3, 3}, {3}});
  const auto more = stratifiedRankSum(strata);
  EXPECT_DOUBLE_EQ(more->z, s->z);
  EXPECT_EQ(more->left, 2U);
  expectNames(stratifiedRankSum(std::vector<Stratum>{{{1, 2}, {}}}).reason(), {});
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/resampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

const Values skewed{1.2, 0.3, 4.5, 2.2, 9.8, 0.7, 3.1, 1.9, 0.4, 6.0};

Expected<double> meanDifference(std::span<const double> x, std::span<const double> y) { return *mean(x) - *mean(y); }

TEST(RandomStream, bitsAreFixed) {
  // The C++ standard: the 10,000th draw of a default mt19937_64, seed 5489, is 9981545732273789042.
  RandomStream stream(5489);
  std::uint64_t last = 0;
  const std::uint64_t most = std::uint64_t{1} << 63;
  for (int i = 0; i < 10000; ++i) last = stream.below(most);  // divides 2^64: nothing is drawn again
  EXPECT_EQ(last, 9981545732273789042U % most);
}

TEST(RandomStream, isUniformNormalAndShuffles) {
  const std::uint64_t seed = 3;
  RandomStream random(seed);
  std::array<int, 7> counts{};
  for (int i = 0; i < 70000; ++i) ++counts[static_cast<std::size_t>(random.below(7))];
  for (const int count : counts) EXPECT_NEAR(count, 10000, 4.0 * std::sqrt(10000.0 * 6.0 / 7.0));
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double z = random.normal();
    ASSERT_TRUE(std::isfinite(z));
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3.0, 4.0 * std::sqrt(96.0 / n));
}

/// Several statistics have the intervals that each of them has alone.
TEST(Bootstrap, severalAreOfTheSameResamples) {
  const auto alone = bootstrap(skewed, [](std::span<const double> v) { return mean(v); }, {.resamples = 499});
  const auto several = bootstrapSeveral({skewed},
                                        [](const ValueGroups& g) {
                                          return Expected<Values>(Values{1.0, *mean(g[0])});
                                        },
                                        {.resamples = 499});
  ASSERT_TRUE(several) << several.reason();
  EXPECT_FALSE(several->front()) << "a constant has no interval";
  EXPECT_EQ((*several)[1]->interval.lower, alone->interval.lower);
  EXPECT_EQ((*several)[1]->interval.upper, alone->interval.upper);
}

TEST(Bootstrap, meanOfASkewedSampleAsRsBoot) {
  // R 4.2.2, boot 1.3-28.1: set.seed(1); boot(x, function(d, i) mean(d[i]), R = 200000); boot.ci: percentile
  // [1.42, 4.94]. The generators differ: the simulated quantiles have a standard error of some .006 (50,000 resamples).
  BootstrapOptions options;
  options.resamples = 49999;
  const auto b = bootstrap(
      skewed, [](std::span<const double> v) { return mean(v); }, options);
  ASSERT_TRUE(b) << b.reason();
  EXPECT_NEAR(b->estimate, 3.01, 1e-12);
  EXPECT_NEAR(b->interval.lower, 1.42, 0.03);
  EXPECT_NEAR(b->interval.upper, 4.94, 0.05);
  EXPECT_EQ(b->interval.method, "percentile bootstrap");
  EXPECT_EQ(b->seed, 1U);
  EXPECT_FALSE(b->extreme);
}

TEST(Bootstrap, differenceOfTwoGroupsAsRsBoot) {
  // The same of sleep, strata = group: percentile [-3.16, -.01].
  BootstrapOptions options;
  options.resamples = 49999;
  options.seed = 9;
  const auto b = bootstrap(data::sleep1, data::sleep2, meanDifference, options);
  ASSERT_TRUE(b) << b.reason();
  EXPECT_NEAR(b->interval.lower, -3.16, 0.04);
  EXPECT_NEAR(b->interval.upper, -0.01, 0.04);
}

TEST(Bootstrap, everyResampleOfTwoValuesIsCounted) {
  // Two values: the mean is a, (a + b) / 2 or b in shares 1/4, 1/2, 1/4, so the 5 % and 95 % quantiles are a and b.
  BootstrapOptions options;
  options.level = 0.9;
  const auto b = bootstrap(
      Values{1, 3}, [](std::span<const double> v) { return mean(v); }, options);
  EXPECT_DOUBLE_EQ(b->interval.lower, 1.0);
  EXPECT_DOUBLE_EQ(b->interval.upper, 3.0);
  options.level = 0.4;  // 30 % and 70 %: both within the middle half
  EXPECT_DOUBLE_EQ(bootstrap(
                       Values{1, 3}, [](std::span<const double> v) { return mean(v); }, options)
                       ->interval.upper,
                   2.0);
}

TEST(Bootstrap, theSeedIsAllThatDecides) {
  BootstrapOptions options;
  options.resamples = 999;
  const auto once = bootstrap(data::sleep1, data::sleep2, meanDifference, options);
  const auto again = bootstrap(data::sleep1, data::sleep2, meanDifference, options);
  EXPECT_EQ(once->interval.lower, again->interval.lower);
  EXPECT_EQ(once->interval.upper, again->interval.upper);
  options.seed = 2;
  EXPECT_NE(bootstrap(data::sleep1, data::sleep2, meanDifference, options)->interval.lower, once->interval.lower);
}

TEST(Bootstrap, degenerate) {
  const auto statistic = [](std::span<const double> v) { return mean(v); };
  EXPECT_EQ(bootstrap(Values{4}, statistic).reason(), bootstrap(Values{4, 4, 4}, statistic).reason());
  expectDistinct({bootstrap(Values{}, statistic).reason(), bootstrap(Values{1, NAN}, statistic).reason(),
                  bootstrap(Values{4, 4, 4}, statistic).reason(),
                  bootstrap(Values{1, 2}, Values{}, meanDifference).reason()});
  // The deviation of two values vanishes in half of the resamples, which here counts as no answer.
  const auto inverse = [](std::span<const double> v) {
    const auto s = standardDeviation(v);
    return s && *s > 0.0 ? Expected<double>(1.0 / *s) : NoResult{"no spread"};
  };
  expectNames(bootstrap(Values{1, 2}, inverse).reason(), {});
}

}  // namespace
}  // namespace calot::analytics

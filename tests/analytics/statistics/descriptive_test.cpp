// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/descriptive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

TEST(Descriptive, meanAndDeviationOfSleep) {
  // R: mean(sleep$extra) 1.54, sd(sleep$extra) 2.01792.
  const Values all{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0,
                   1.9, 0.8,  1.1,  0.1,  -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  EXPECT_NEAR(*mean(all), 1.54, 1e-14);
  EXPECT_NEAR(*standardDeviation(all), 2.01792, 5e-6);
}

TEST(Descriptive, deviationSurvivesALargeOffset) {
  // NIST StRD NumAcc3: mean 1000000.2, deviation 0.1 exactly.
  Values values{1000000.2};
  for (int i = 0; i < 500; ++i) {
    values.push_back(1000000.1);
    values.push_back(1000000.3);
  }
  EXPECT_NEAR(*mean(values), 1000000.2, 1e-9);
  EXPECT_NEAR(*standardDeviation(values), 0.1, 1e-9);
}

TEST(Descriptive, quantileIsTypeSeven) {
  const Values values{4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(*quantile(values, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(*median(values), 2.5);
  EXPECT_DOUBLE_EQ(*quantile(values, 0.75), 3.25);
  EXPECT_DOUBLE_EQ(*quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(*quantile(values, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(*quantile(Values{10, 20, 30, 40, 50, 60, 70, 80, 90, 100}, 0.99), 99.1);
  EXPECT_DOUBLE_EQ(*quantile(Values{7.0}, 0.3), 7.0);
}

TEST(Descriptive, degenerateInputAnswersWithAReason) {
  const Values none, one{1.0}, bad{1.0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(median(none).reason(), mean(none).reason());
  EXPECT_EQ(quantile(bad, 0.5).reason(), mean(bad).reason());
  EXPECT_EQ(standardDeviation(bad).reason(), mean(bad).reason());
  expectDistinct({mean(none).reason(), standardDeviation(one).reason(), mean(bad).reason()});
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/rank_tests.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

void expectAll(const Expected<Values>& answer, const Values& expected, double tolerance) {
  ASSERT_TRUE(answer) << answer.reason();
  ASSERT_EQ(answer->size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR((*answer)[i], expected[i], tolerance) << i;
}

TEST(Multiplicity, four) {
  // R 4.2.2: p.adjust(p, "holm"), p.adjust(p, "BH").
  const Values p{.01, .04, .03, .005};
  expectAll(holm(p), {.03, .06, .06, .02}, 1e-15);
  expectAll(benjaminiHochberg(p), {.02, .04, .04, .02}, 1e-15);
}

TEST(Multiplicity, theExampleOfBenjaminiAndHochberg) {
  // Their 15 p values of 1995 (thrombolysis after myocardial infarction): at 5 % BH rejects four, Holm three. Adjusted:
  // R 4.2.2.
  const Values p{.0001, .0004, .0019, .0095, .0201, .0278, .0298, .0344, .0459, .3240, .4262, .5719, .6528, .7590, 1};
  const auto h = holm(p), bh = benjaminiHochberg(p);
  const auto rejected = [](const Values& adjusted) {
    return std::count_if(adjusted.begin(), adjusted.end(), [](double v) { return v <= 0.05; });
  };
  EXPECT_EQ(rejected(*bh), 4);
  EXPECT_EQ(rejected(*h), 3);
  expectAll(h, {.0015, .0056, .0247, .1140, .2211, .2780, .2780, .2780, .3213, 1, 1, 1, 1, 1, 1}, 1e-14);
  expectAll(bh,
            {.0015, .0030, .0095, .035625, .0603, .0638571428571429, .0638571428571429, .0645, .0765, .486,
             .5811818181818181, .7148749999999999, .7532307692307693, .8132142857142857, 1},
            1e-14);
}

TEST(Multiplicity, edges) {
  EXPECT_EQ(benjaminiHochberg(Values{.1, NAN}).reason(), holm(Values{.1, 1.1}).reason());
  expectDistinct({holm(Values{}).reason(), holm(Values{.1, 1.1}).reason()});
  expectAll(holm(Values{.2}), {.2}, 0.0);
  expectAll(benjaminiHochberg(Values{.2}), {.2}, 0.0);
  expectAll(holm(Values{.2, .2, .2}), {.6, .6, .6}, 1e-15);
}

}  // namespace
}  // namespace calot::analytics

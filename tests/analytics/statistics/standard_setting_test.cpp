// SPDX-License-Identifier: GPL-3.0-or-later
// Borderline regression and Angoff's method.
#include <gtest/gtest.h>

#include "analytics/statistics/standard_setting.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

TEST(BorderlineRegression, cutOfR) {
  // R 4.2.2: predict(lm(mpg ~ wt, mtcars), data.frame(wt = 3), interval = "confidence").
  const auto r = borderlineRegression(data::weight, data::mpg, 3.0, Better::lower);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->cut, 21.251711449174, 1e-11);
  EXPECT_NEAR(r->interval.lower, 20.1244355874084, 1e-11);
  EXPECT_NEAR(r->interval.upper, 22.3789873109395, 1e-11);
  EXPECT_NEAR(r->r, -0.867659376517228, 1e-12);
  EXPECT_EQ(r->atOrBelowMark, 12U);
}

TEST(BorderlineRegression, refuses) {
  const data::Values rating{1, 2, 3, 4, 5}, score{2, 3, 5, 4, 6};
  const auto reason = [&](const data::Values& x, double mark, Better better) {
    return borderlineRegression(x, score, mark, better).reason();
  };
  expectDistinct({reason(rating, 3, Better::lower), reason(rating, 0.5, Better::higher),
                  reason({2, 2, 2, 2, 2}, 2, Better::higher), reason({1, 2}, 1, Better::higher)});
}

TEST(Angoff, judgesOfR) {
  // R 4.2.2: t.test(rowSums(J)).
  const RatingTable judged{3, 4, {.6, .7, .5, .8, .55, .75, .6, .7, .7, .8, .4, .9}};
  const auto r = angoffCut(judged);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->cut, 2.66666666666667, 1e-13);
  EXPECT_NEAR(r->error, 0.0666666666666666, 1e-14);
  EXPECT_NEAR(r->interval.lower, 2.37982315135004, 1e-12);
  EXPECT_NEAR(r->interval.upper, 2.9535101819833, 1e-12);
}

TEST(Angoff, refuses) {
  expectDistinct({angoffCut({1, 2, {.5, .5}}).reason(), angoffCut({2, 1, {.5, 1.5}}).reason(),
                  angoffCut({2, 2, {.1, .2, .2, .1}}).reason()});
}

}  // namespace
}  // namespace calot::analytics

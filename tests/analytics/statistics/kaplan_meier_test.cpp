// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/survival.h"

#include <gtest/gtest.h>

#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

std::vector<CensoredTime> survivalTimes(const data::Values& time, const data::Values& event) {
  std::vector<CensoredTime> times;
  for (std::size_t i = 0; i < time.size(); ++i) times.push_back({time[i], event[i] > 0.0});
  return times;
}

TEST(KaplanMeier, mediansOfR) {
  // survival 3.5-3 on R 4.2.2: survfit(Surv(time, status) ~ x, aml, conf.type = "log-log").
  const auto kept = kaplanMeier(survivalTimes(data::maintainedTime, data::maintainedEvent));
  ASSERT_TRUE(kept) << kept.reason();
  EXPECT_EQ(kept->finished, 7U);
  EXPECT_DOUBLE_EQ(kept->median.value(), 31.0);
  EXPECT_DOUBLE_EQ(kept->lower.value(), 13.0);
  EXPECT_FALSE(kept->upper);
  const auto not_ = kaplanMeier(survivalTimes(data::notMaintainedTime, data::notMaintainedEvent));
  ASSERT_TRUE(not_) << not_.reason();
  EXPECT_DOUBLE_EQ(not_->median.value(), 23.0);
  EXPECT_DOUBLE_EQ(not_->lower.value(), 5.0);
  EXPECT_DOUBLE_EQ(not_->upper.value(), 33.0);
}

TEST(KaplanMeier, curveOfR) {
  // Both groups: survfit(Surv(time, status) ~ 1, aml, conf.type = "log-log").
  std::vector<CensoredTime> both = survivalTimes(data::maintainedTime, data::maintainedEvent);
  for (const CensoredTime& t : survivalTimes(data::notMaintainedTime, data::notMaintainedEvent)) both.push_back(t);
  const auto r = kaplanMeier(both);
  ASSERT_TRUE(r) << r.reason();
  ASSERT_EQ(r->steps.size(), 15U);
  EXPECT_DOUBLE_EQ(r->steps[6].followed, 13.0);
  EXPECT_NEAR(r->steps[6].unfinished, 0.54658385093, 1e-11);
  EXPECT_NEAR(r->steps[14].unfinished, 0.08281573499, 1e-11);
  EXPECT_DOUBLE_EQ(r->median.value(), 27.0);
  EXPECT_DOUBLE_EQ(r->lower.value(), 13.0);
  EXPECT_DOUBLE_EQ(r->upper.value(), 34.0);
  // Four that all finish: at one half exactly, midway to the next.
  const auto four = kaplanMeier(std::vector<CensoredTime>{{1, true}, {2, true}, {3, true}, {4, true}});
  EXPECT_DOUBLE_EQ(four->median.value(), 2.5);
  EXPECT_DOUBLE_EQ(four->lower.value(), 1.0);
  EXPECT_FALSE(four->upper);
}

TEST(KaplanMeier, withoutAMedianOrAnAnswer) {
  const auto few = kaplanMeier(std::vector<CensoredTime>{{1, true}, {2, false}, {3, false}, {4, false}});
  ASSERT_TRUE(few) << few.reason();
  EXPECT_FALSE(few->median);
  expectDistinct({kaplanMeier(std::vector<CensoredTime>{}).reason(),
                  kaplanMeier(std::vector<CensoredTime>{{1, false}}).reason(),
                  kaplanMeier(std::vector<CensoredTime>{{0, true}}).reason()});
}

TEST(AttemptsToCriterion, firstOfARunAndCensoredWithout) {
  const data::Values seconds{9, 4, 7, 5, 5, 3};
  const CensoredTime once = attemptsToCriterion(seconds, 5, Better::lower);
  EXPECT_TRUE(once.finished);
  EXPECT_DOUBLE_EQ(once.time, 2.0);
  EXPECT_DOUBLE_EQ(attemptsToCriterion(seconds, 5, Better::lower, 2).time, 5.0);
  const CensoredTime never = attemptsToCriterion(seconds, 10, Better::higher);
  EXPECT_FALSE(never.finished);
  EXPECT_DOUBLE_EQ(never.time, 6.0);
}

}  // namespace
}  // namespace calot::analytics

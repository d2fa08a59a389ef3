// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/survival.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Times = std::vector<CensoredTime>;

Times timesOf(const std::vector<double>& time, const std::vector<double>& event) {
  Times t;
  for (std::size_t i = 0; i < time.size(); ++i) t.push_back({time[i], event[i] == 1.0});
  return t;
}

const Times ovarian1 = timesOf(data::ovarianTime1, data::ovarianEvent1);
const Times ovarian2 = timesOf(data::ovarianTime2, data::ovarianEvent2);

TEST(LogRank, ovarian) {
  // survival 3.5-3 on R 4.2.2: survdiff(Surv(futime, fustat) ~ rx, ovarian).
  const auto l = logRank(ovarian1, ovarian2);
  ASSERT_TRUE(l) << l.reason();
  EXPECT_DOUBLE_EQ(l->observed, 7.0);
  EXPECT_NEAR(l->expected, 5.233531017149943, 1e-14);
  EXPECT_NEAR(l->variance, 2.936196129483156, 1e-14);
  EXPECT_NEAR(l->z * l->z, 1.062739861291414, 1e-14);
  EXPECT_GT(l->z, 0.0);
  EXPECT_NEAR(l->p, 0.302591116989095, 1e-14);
  const auto turned = logRank(ovarian2, ovarian1);
  EXPECT_NEAR(turned->z, -l->z, 1e-13);
}

TEST(LogRank, leukaemiaWithTiedTimes) {
  // survdiff(Surv(time, status) ~ x, aml).
  const auto l = logRank(timesOf(data::maintainedTime, data::maintainedEvent),
                         timesOf(data::notMaintainedTime, data::notMaintainedEvent));
  ASSERT_TRUE(l) << l.reason();
  EXPECT_DOUBLE_EQ(l->observed, 7.0);
  EXPECT_NEAR(l->expected, 10.6893359923007250, 1e-13);
  EXPECT_NEAR(l->variance, 4.0075507459387349, 1e-13);
  EXPECT_NEAR(l->z * l->z, 3.3963886989776011, 1e-13);
  EXPECT_NEAR(l->p, 0.0653393220405051, 1e-14);
  EXPECT_LT(l->z, 0.0);
}

TEST(LogRank, degenerate) {
  const Times one{{5, true}}, none{}, given{{5, false}, {6, false}}, bad{{0, true}};
  expectDistinct({logRank(none, one).reason(), logRank(one, none).reason(), logRank(given, given).reason(),
                  logRank(one, bad).reason()});
  // All of the first group are gone before anyone of the second finishes, and the first never does.
  expectNames(logRank(Times{{1, false}}, Times{{5, true}, {7, true}}).reason(), {});
}

TEST(WorstRank, unfinishedStandsBehindEveryFinishedOne) {
  // R 4.2.2: v <- ifelse(ovarian$fustat == 1, ovarian$futime, 9999); wilcox.test(v[rx == 1], v[rx == 2], exact =
  // FALSE): W 61, p .19930473922467 (asymptotic; ours is exact with ties).
  const auto w = worstRank(ovarian1, ovarian2, Hypothesis::firstSmaller);
  ASSERT_TRUE(w) << w.reason();
  EXPECT_DOUBLE_EQ(w->test.u, 61.0);
  EXPECT_TRUE(w->test.exact);
  EXPECT_NEAR(w->test.p, 0.19930473922467, 0.01);
  EXPECT_NEAR(w->effect.value.a, 1.0 - 61.0 / 169.0, 1e-15);
  // When someone gave up does not matter; that someone gave up does.
  Times later = ovarian1;
  for (CensoredTime& t : later) t.time += t.finished ? 0.0 : 5000.0;
  EXPECT_DOUBLE_EQ(worstRank(later, ovarian2, Hypothesis::firstSmaller)->test.u, 61.0);
  // Who gave up after a second is behind who needed an hour.
  const auto quick =
      worstRank(Times{{1, false}, {2, false}}, Times{{3600, true}, {3700, true}}, Hypothesis::firstSmaller);
  EXPECT_DOUBLE_EQ(quick->effect.value.a, 0.0);
  expectDistinct({worstRank(Times{{1, false}}, Times{{3, false}}, Hypothesis::firstSmaller).reason(),
                  worstRank(Times{}, ovarian2, Hypothesis::firstSmaller).reason()});
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/descriptive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <span>

#include "analytics/statistics/mixed_models.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// nlme's Orthodont, boys against girls. @param left (child, visit) that are left out.
std::vector<ModelAttempt> orthodont(const std::set<std::pair<std::size_t, std::size_t>>& left, bool sites) {
  std::vector<ModelAttempt> attempts;
  for (std::size_t child = 0; child < 27; ++child) {
    for (std::size_t visit = 0; visit < 4; ++visit) {
      if (left.count({child, visit}) > 0) continue;
      attempts.push_back({child, child >= 11, sites ? (child + 1) % 2 : 0, data::distance[4 * child + visit]});
    }
  }
  return attempts;
}

/// as.data.frame(Orthodont)[-c(2, 3, 7, 50, 51, 52, 99, 106), ].
const std::set<std::pair<std::size_t, std::size_t>> missing{{11, 1}, {11, 2}, {12, 2}, {23, 1},
                                                            {23, 2}, {23, 3}, {8, 2},  {10, 1}};

TEST(RandomIntercept, balanced) {
  // nlme 3.1-162 on R 4.2.2: lme(distance ~ (Sex == "Male"), random = ~ 1 | Subject, Orthodont), which stops some 1e-7
  // short of the maximum, as the closed form below shows.
  const auto r = randomIntercept(orthodont({}, false));
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->estimate, 2.32102272727273, 1e-11);
  EXPECT_NEAR(r->error, 0.761416973079967, 2e-7);
  EXPECT_DOUBLE_EQ(r->df, 25.0);
  EXPECT_NEAR(r->t, 3.04829391691136, 1e-6);
  EXPECT_NEAR(r->p, 5.37506239320817e-03, 1e-8);
  EXPECT_NEAR(r->betweenVariance, 2.54670310023101, 2e-6);
  EXPECT_NEAR(r->withinVariance, 4.92978345291149, 1e-6);
  EXPECT_NEAR(r->restrictedLogLikelihood, -252.935885962210, 1e-9);
  // Balanced, so it is also Student's test of the children's means, in closed form.
  std::vector<double> girls, boys;
  double within = 0.0;
  for (std::size_t child = 0; child < 27; ++child) {
    const std::span<const double> visits(&data::distance[4 * child], 4);
    (child < 11 ? girls : boys).push_back(*mean(visits));
    within += 3.0 * std::pow(*standardDeviation(visits), 2);
  }
  const double between =
      (10.0 * std::pow(*standardDeviation(girls), 2) + 15.0 * std::pow(*standardDeviation(boys), 2)) / 25.0;
  EXPECT_NEAR(r->error, std::sqrt(between * (1.0 / 11.0 + 1.0 / 16.0)), 1e-12);
  EXPECT_NEAR(r->withinVariance, within / 81.0, 1e-10);
  EXPECT_NEAR(r->betweenVariance, between - within / 81.0 / 4.0, 1e-10);
}

TEST(RandomIntercept, unbalancedAndWithSites) {
  // The same with eight visits missing, and with a second stratum. nlme and lme4 themselves differ by 1e-7 in the
  // errors.
  const auto r = randomIntercept(orthodont(missing, false));
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->estimate, 2.0769930210847, 2e-7);
  EXPECT_NEAR(r->error, 0.87656614317134, 5e-7);
  EXPECT_NEAR(r->p, 2.5846150661315e-02, 1e-7);
  EXPECT_NEAR(r->betweenVariance, 3.81078347123485, 1e-5);
  EXPECT_NEAR(r->withinVariance, 4.30961285937310, 1e-5);
  EXPECT_NEAR(r->restrictedLogLikelihood, -232.47398461893994, 1e-9);
  const auto s = randomIntercept(orthodont(missing, true));
  ASSERT_TRUE(s) << s.reason();
  EXPECT_NEAR(s->estimate, 2.10084960197, 2e-7);
  EXPECT_NEAR(s->error, 0.873769064169, 5e-7);
  EXPECT_DOUBLE_EQ(s->df, 24.0);
  EXPECT_NEAR(s->p, 2.42773129620e-02, 1e-7);
  EXPECT_NEAR(s->betweenVariance, 3.780006, 1e-5);
  EXPECT_NEAR(s->withinVariance, 4.296624, 1e-5);
}

TEST(RandomIntercept, participantsNoMoreAlikeThanOthersStandAtTheBound) {
  // Each participant's attempts spread over all values: the variance between is 0, and the rest is a plain comparison.
  std::vector<ModelAttempt> attempts;
  for (std::size_t p = 0; p < 6; ++p) {
    for (const double v : {1.0, 5.0, 9.0}) attempts.push_back({p, p < 3, 0, v + (p < 3 ? 2.0 : 0.0)});
  }
  const auto r = randomIntercept(attempts);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_DOUBLE_EQ(r->betweenVariance, 0.0);
  EXPECT_NEAR(r->estimate, 2.0, 1e-13);
  EXPECT_NEAR(r->withinVariance, 6.0 * 32.0 / 16.0, 1e-12);
}

TEST(RandomIntercept, holdsItsLevelWhereSingleAttemptsWouldNot) {
  // Nothing differs but people. The model rejects in 5 %; taking all attempts as independent would reject in over 20 %.
  const unsigned seed = 31;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  int rejected = 0;
  const int studies = 600;
  for (int study = 0; study < studies; ++study) {
    std::vector<ModelAttempt> attempts;
    for (std::size_t p = 0; p < 16; ++p) {
      const double person = 2.0 * normal(random);
      for (std::size_t k = 0; k < 3 + p % 3; ++k) attempts.push_back({p, p % 2 == 0, 0, person + normal(random)});
    }
    const auto r = randomIntercept(attempts);
    ASSERT_TRUE(r) << r.reason();
    if (r->p <= 0.05) ++rejected;
  }
  EXPECT_NEAR(rejected / static_cast<double>(studies), 0.05, 4.0 * std::sqrt(0.05 * 0.95 / studies));
}

TEST(RandomIntercept, degenerate) {
  const auto reason = [](const std::vector<ModelAttempt>& a) { return randomIntercept(a).reason(); };
  expectDistinct({reason({}), reason({{0, true, 0, 1}, {0, true, 0, 2}}), reason({{0, true, 0, 1}, {0, false, 0, 2}}),
                  reason({{0, true, 0, 1}, {0, true, 1, 2}})});
  expectDistinct({reason({{0, true, 0, 1}, {1, false, 0, 2}, {2, false, 0, 4}}),
                  reason({{0, true, 0, 1}, {0, true, 0, 1}, {1, false, 0, 2}, {2, false, 0, 3}})});
  expectDistinct({reason({{0, true, 0, 1}, {0, true, 0, NAN}, {1, false, 0, 2}}),
                  reason({{0, true, 0, 1}, {0, true, 0, 2}, {1, false, 0, 2}})});
  expectNames(
      reason({{0, true, 0, 1}, {0, true, 0, 2}, {1, true, 0, 4}, {2, false, 1, 2}, {2, false, 1, 5}, {3, false, 1, 3}}),
      {"group", "site"});
}

TEST(OnePerParticipant, firstAndMean) {
  const std::vector<RepeatedValue> values{{7, 2, 10}, {3, 1, 5}, {7, 1, 20}, {7, 3, 60}};
  const auto first = onePerParticipant(values, AttemptRule::first),
             average = onePerParticipant(values, AttemptRule::mean);
  ASSERT_TRUE(first && average);
  ASSERT_EQ(first->size(), 2U);
  EXPECT_EQ((*first)[0].participant, 3U);
  EXPECT_DOUBLE_EQ((*first)[0].value, 5.0);
  EXPECT_DOUBLE_EQ((*first)[1].value, 20.0);
  EXPECT_EQ((*first)[1].attempts, 3U);
  EXPECT_DOUBLE_EQ((*average)[1].value, 30.0);
}

TEST(OnePerParticipant, degenerate) {
  expectNames(onePerParticipant({}, AttemptRule::mean).reason(), {});
  const std::vector<RepeatedValue> twice{{7, 1, 10}, {7, 1, 11}}, bad{{7, 1, NAN}};
  expectNames(onePerParticipant(twice, AttemptRule::first).reason(), {});
  EXPECT_TRUE(onePerParticipant(twice, AttemptRule::mean));
  expectNames(onePerParticipant(bad, AttemptRule::mean).reason(), {});
}

}  // namespace
}  // namespace calot::analytics

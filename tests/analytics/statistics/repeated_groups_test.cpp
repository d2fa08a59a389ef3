// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/mixed_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "analytics/statistics/resampling.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// nlme's Orthodont, boys as x. @param left (child, visit) that are left out.
std::vector<OccasionValue> growth(const std::set<std::pair<std::size_t, std::size_t>>& left = {}) {
  std::vector<OccasionValue> values;
  for (std::size_t child = 0; child < 27; ++child) {
    for (std::size_t visit = 0; visit < 4; ++visit) {
      if (left.count({child, visit}) > 0) continue;
      values.push_back({child, child >= 11, 8.0 + 2.0 * static_cast<double>(visit), data::distance[4 * child + visit]});
    }
  }
  return values;
}

void expectTerm(const ModelTerm& term, double estimate, double error, double df, double p) {
  EXPECT_NEAR(term.estimate, estimate, 1e-8);
  EXPECT_NEAR(term.error, error, 1e-8);
  EXPECT_DOUBLE_EQ(term.df, df);
  EXPECT_NEAR(term.p, p, 1e-8);
  EXPECT_NEAR(term.interval.upper + term.interval.lower, 2.0 * term.estimate, 1e-12);
}

TEST(RepeatedGroups, slopesOfR) {
  // nlme 3.1-162 on R 4.2.2: lme(distance ~ M * I(age - 8), random = ~ 1 | Subject, Orthodont), M 1 for boys. nlme
  // stops some 1e-8 short of the maximum; balanced, the model has a closed form by lm(distance ~ Subject + A + M:A) and
  // the children's means, which gives the group's error and p and both variances to all digits.
  const auto r = repeatedGroups(growth(), OccasionKind::number);
  ASSERT_TRUE(r) << r.reason();
  ASSERT_EQ(r->interaction.size(), 1U);
  expectTerm(r->group, 1.406534090909090, 0.844063340839652, 25.0, 0.108119037184001);
  expectTerm(r->occasion[0], 0.479545454545455, 0.0934698493999794, 79.0, 2.01741388779838e-06);
  expectTerm(r->interaction[0], 0.304829545454546, 0.1214208961024318, 79.0, 0.0140974506731300);
  EXPECT_NEAR(r->betweenVariance, 3.29863402617951, 1e-10);
  EXPECT_NEAR(r->withinVariance, 1.92205480437284, 1e-10);
  EXPECT_NEAR(r->restrictedLogLikelihood, -216.878624600568, 1e-9);
}

TEST(RepeatedGroups, namedOccasionsOfR) {
  // The same with factor(age); the group's error and p by the closed form.
  const auto r = repeatedGroups(growth(), OccasionKind::named);
  ASSERT_TRUE(r) << r.reason();
  ASSERT_EQ(r->occasion.size(), 3U);
  expectTerm(r->group, 1.693181818181815, 0.898330224012287, 25.0, 0.0711320519405547);
  expectTerm(r->occasion[2], 2.909090909090911, 0.599247691778124, 75.0, 6.41411021965454e-06);
  expectTerm(r->interaction[0], -0.107954545454545, 0.778445586358564, 75.0, 0.890075007150225);
  expectTerm(r->interaction[2], 1.684659090909093, 0.778445586358564, 75.0, 3.36378182780419e-02);
  EXPECT_NEAR(r->restrictedLogLikelihood, -211.704266413803, 1e-9);
}

TEST(RepeatedGroups, missingVisits) {
  // The same of as.data.frame(Orthodont)[-c(2, 3, 7, 50, 51, 52, 99, 106), ].
  const std::set<std::pair<std::size_t, std::size_t>> missing{{11, 1}, {11, 2}, {12, 2}, {23, 1},
                                                              {23, 2}, {23, 3}, {8, 2},  {10, 1}};
  const auto r = repeatedGroups(growth(missing), OccasionKind::number);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_DOUBLE_EQ(r->interaction[0].df, 71.0);
  EXPECT_NEAR(r->restrictedLogLikelihood, -196.611572439029, 1e-8);
  EXPECT_NEAR(r->group.estimate, 1.384243018251681, 1e-6);
  EXPECT_NEAR(r->interaction[0].estimate, 0.243391594002829, 1e-6);
  EXPECT_NEAR(r->interaction[0].p, 3.06268775974044e-02, 1e-6);
}

/// Twelve people of two groups with three to five attempts each, groups apart by `group` and `slope`.
std::vector<OccasionValue> drawn(RandomStream& random, double group, double slope) {
  std::vector<OccasionValue> values;
  for (std::size_t person = 0; person < 12; ++person) {
    const double level = 2.0 * random.normal();
    const bool x = person % 2 == 0;
    for (std::size_t k = 0; k < 3 + person % 3; ++k) {
      const double step = static_cast<double>(k);
      values.push_back(
          {person, x, step + 1.0, level - 0.5 * step + (x ? group + slope * step : 0.0) + random.normal()});
    }
  }
  return values;
}

TEST(RepeatedGroups, keepsItsLevelAndFindsPlantedEffects) {
  const int studies = std::getenv("CALOT_HEAVY") != nullptr ? 10000 : 800;
  const std::uint64_t seed = 71;
  RecordProperty("seed", std::to_string(seed));
  RandomStream random(seed);
  int group = 0, interaction = 0, covered = 0, found = 0;
  for (int study = 0; study < studies; ++study) {
    const auto same = repeatedGroups(drawn(random, 0.0, 0.0), OccasionKind::number);
    ASSERT_TRUE(same) << same.reason();
    group += same->group.p <= 0.05 ? 1 : 0;
    interaction += same->interaction[0].p <= 0.05 ? 1 : 0;
    const auto apart = repeatedGroups(drawn(random, 8.0, 1.5), OccasionKind::number);
    ASSERT_TRUE(apart) << apart.reason();
    const ModelTerm& term = apart->interaction[0];
    covered += term.interval.lower <= 1.5 && 1.5 <= term.interval.upper ? 1 : 0;
    found += apart->group.p <= 0.05 && apart->group.estimate > 0.0 ? 1 : 0;
  }
  const double chance = 4.0 * std::sqrt(0.05 * 0.95 / studies);
  EXPECT_NEAR(group / static_cast<double>(studies), 0.05, chance);
  EXPECT_NEAR(interaction / static_cast<double>(studies), 0.05, chance);
  EXPECT_NEAR(covered / static_cast<double>(studies), 0.95, chance);
  EXPECT_GT(found, studies * 9 / 10);
}

TEST(RepeatedGroups, refusesWhatHasNoSuchDesign) {
  const auto reason = [](const std::vector<OccasionValue>& v, OccasionKind kind = OccasionKind::number) {
    return repeatedGroups(v, kind).reason();
  };
  expectDistinct({reason({}), reason({{0, true, 1, 1}, {0, false, 2, 2}})});
  std::vector<OccasionValue> once;
  for (std::size_t p = 0; p < 8; ++p) once.push_back({p, p % 2 == 0, 1.0, static_cast<double>(p * p)});
  expectNames(reason(once), {});
  for (std::size_t p = 0; p < 8; p += 2) once.push_back({p, true, 2.0, static_cast<double>(p)});
  expectNames(reason(once, OccasionKind::named), {});
  // Each participant once: occasions of different people are no repetition.
  std::vector<OccasionValue> apart;
  for (std::size_t p = 0; p < 8; ++p) apart.push_back({p, p % 2 == 0, p < 4 ? 1.0 : 2.0, static_cast<double>(p * p)});
  expectNames(reason(apart), {});
}

}  // namespace
}  // namespace calot::analytics

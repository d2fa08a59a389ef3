// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "analytics/statistics/mixed_models.h"
#include "analytics/statistics/two_groups.h"
#include "tests/analytics/statistics/support/published_data.h"

namespace calot::analytics {
namespace {

constexpr std::size_t girls = 11;

/// nlme's Orthodont. @param left (child, visit) that are left out.
std::vector<OccasionValue> growth(const std::set<std::pair<std::size_t, std::size_t>>& left = {}) {
  std::vector<OccasionValue> values;
  for (std::size_t child = 0; child < 27; ++child) {
    for (std::size_t visit = 0; visit < 4; ++visit) {
      if (left.count({child, visit}) == 0)
        values.push_back({child, 8.0 + 2.0 * static_cast<double>(visit), data::distance[4 * child + visit]});
    }
  }
  return values;
}

/// Boys and girls.
std::array<std::vector<double>, 2> bySex(const std::vector<ParticipantValue>& changes) {
  std::array<std::vector<double>, 2> groups;
  for (const ParticipantValue& c : changes) groups[c.participant < girls ? 1 : 0].push_back(c.value);
  return groups;
}

double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v / static_cast<double>(values.size());
  return sum;
}

TEST(PersonalChanges, slopesOfR) {
  // coef(lmList(distance ~ age | Subject, Orthodont)) of nlme: F01 .375, M01 .95, M13 1.95; balanced,
  // the mean slopes are the fixed effects of lme(distance ~ Sex * age, random = ~ age | Subject): .479545 and .304830.
  const auto changes = personalChanges(growth(), OccasionKind::number);
  ASSERT_EQ(changes.size(), 1U);
  ASSERT_EQ(changes[0].size(), 27U);
  EXPECT_NEAR(changes[0][0].value, 0.375, 1e-13);
  EXPECT_NEAR(changes[0][11].value, 0.95, 1e-13);
  EXPECT_NEAR(changes[0][23].value, 1.95, 1e-13);
  EXPECT_EQ(changes[0][23].attempts, 4U);
  const auto [boys, others] = bySex(changes[0]);
  EXPECT_NEAR(meanOf(others), 0.479545454545455, 1e-12);
  EXPECT_NEAR(meanOf(boys) - meanOf(others), 0.304829545454546, 1e-12);
  // wilcox.test on the slopes: W 132.5; the exact p with ties, of all 13,037,895 assignments.
  std::array<std::vector<double>, 2> rounded{boys, others};
  for (auto& group : rounded) {
    for (double& v : group) v = std::round(v * 1e6) / 1e6;
  }
  const auto test = mannWhitney(rounded[0], rounded[1]);
  EXPECT_DOUBLE_EQ(test->u, 132.5);
  EXPECT_NEAR(test->p, 0.026828180469316558, 1e-13);
}

TEST(PersonalChanges, whoHasNoSuchChangeIsLeftOut) {
  const auto slopes = personalChanges(growth({{0, 1}, {0, 2}, {0, 3}, {1, 0}}), OccasionKind::number);
  ASSERT_EQ(slopes[0].size(), 26U);
  EXPECT_EQ(slopes[0][0].participant, 1U);
  // 21.5, 24, 25.5 at 10, 12 and 14.
  EXPECT_NEAR(slopes[0][0].value, 1.0, 1e-13);
  const auto named = personalChanges(growth({{0, 1}, {1, 0}}), OccasionKind::named);
  ASSERT_EQ(named.size(), 3U);
  EXPECT_EQ(named[0].size(), 25U) << "without 8 or without 10 years";
  EXPECT_EQ(named[2].size(), 26U) << "without 8 years";
  EXPECT_DOUBLE_EQ(named[2][0].value, 2.0);
  EXPECT_TRUE(personalChanges(std::vector<OccasionValue>{{0, 1.0, 2.0}, {1, 1.0, 3.0}}, OccasionKind::number).empty());
  EXPECT_TRUE(personalChanges(std::vector<OccasionValue>{{0, 1.0, NAN}}, OccasionKind::number).empty());
}

}  // namespace
}  // namespace calot::analytics

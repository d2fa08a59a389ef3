// SPDX-License-Identifier: GPL-3.0-or-later
// Variance components of a crossed facet, and the error of measurement.
#include "analytics/statistics/reliability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "analytics/statistics/resampling.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

const RatingTable sixByFour{6, 4, data::shroutFleiss};

TEST(Generalizability, componentsOfR) {
  // R 4.2.2: ms <- anova(lm(y ~ p + r))[["Mean Sq"]] of Shrout and Fleiss' table; (ms[1] - ms[3]) / 4 and so on.
  const auto r = generalizability(sixByFour);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->person, 2.55555555555556, 1e-13);
  EXPECT_NEAR(r->facet, 5.24444444444444, 1e-13);
  EXPECT_NEAR(r->residual, 1.01944444444444, 1e-13);
  EXPECT_FALSE(r->truncated);
  EXPECT_NEAR(r->at(1).g, 0.714840714840715, 1e-13);
  EXPECT_NEAR(r->at(1).phi, 0.289763779527559, 1e-13);
  EXPECT_NEAR(r->at(2).phi, 0.44932844932845, 1e-13);
  EXPECT_NEAR(r->at(8).absoluteError, 0.884865024233137, 1e-13);
  EXPECT_NEAR(r->at(8).relativeError, 0.356974166510065, 1e-13);
}

TEST(Generalizability, coefficientsAreTheIntraclassCorrelations) {
  const auto r = generalizability(sixByFour);
  EXPECT_NEAR(r->at(4).g, intraclassCorrelation(sixByFour, IccForm::threeAverage)->value, 1e-13);
  EXPECT_NEAR(r->at(4).phi, intraclassCorrelation(sixByFour, IccForm::twoAverage)->value, 1e-13);
  EXPECT_NEAR(r->at(1).phi, intraclassCorrelation(sixByFour, IccForm::twoSingle)->value, 1e-13);
  const Interval icc = *intraclassCorrelation(sixByFour, IccForm::threeAverage)->interval;
  EXPECT_NEAR(r->gInterval->lower, icc.lower, 1e-12);
  EXPECT_NEAR(r->gInterval->upper, icc.upper, 1e-12);
}

/// A second group that lies elsewhere changes nothing within groups, and everything in the whole.
TEST(Generalizability, peopleAreNestedInGroups) {
  RatingTable other = sixByFour, whole = sixByFour;
  for (double& v : other.values) v += 50.0;
  whole.subjects = 12;
  whole.values.insert(whole.values.end(), other.values.begin(), other.values.end());
  const RatingTable groups[] = {sixByFour, other};
  const auto one = generalizability(sixByFour), nested = generalizability(groups);
  ASSERT_TRUE(nested) << nested.reason();
  EXPECT_EQ(nested->people, 12U);
  EXPECT_NEAR(nested->person, one->person, 1e-12);
  EXPECT_NEAR(nested->facet, one->facet, 1e-12);
  EXPECT_NEAR(nested->residual, one->residual, 1e-12);
  EXPECT_GT(nested->gInterval->lower, one->gInterval->lower) << "twice the people";
  EXPECT_GT(generalizability(whole)->at(4).g, 0.99);
}

/// Synthetic data set 4 of Brennan (2001, table 3.2): ten persons, and four raters in each of three tasks. Here tasks
/// are the groups, raters the people in them, persons the levels.
std::vector<RatingTable> syntheticFour() {
  constexpr int scores[10][12] = {{5, 6, 5, 5, 5, 3, 4, 5, 6, 7, 3, 3}, {9, 3, 7, 7, 7, 5, 5, 5, 7, 7, 5, 2},
                                  {3, 4, 3, 3, 5, 3, 3, 5, 6, 5, 1, 6}, {7, 5, 5, 3, 3, 1, 4, 3, 5, 3, 3, 5},
                                  {9, 2, 9, 7, 7, 7, 3, 7, 2, 7, 5, 3}, {3, 4, 3, 5, 3, 3, 6, 3, 4, 5, 1, 2},
                                  {7, 3, 7, 7, 7, 5, 5, 7, 5, 5, 5, 4}, {5, 8, 5, 7, 7, 5, 5, 4, 3, 2, 1, 1},
                                  {9, 9, 8, 8, 6, 6, 6, 5, 5, 8, 1, 1}, {4, 4, 4, 3, 3, 5, 6, 5, 5, 7, 1, 1}};
  std::vector<RatingTable> tasks(3, RatingTable{4, 10, {}});
  for (std::size_t rater = 0; rater < 12; ++rater) {
    for (const auto& person : scores) tasks[rater / 4].values.push_back(person[rater]);
  }
  return tasks;
}

TEST(Generalizability, ofBrennansRatersNestedInTasks) {
  // Printed there, all facets random: p .4731, t .3252, r:t .6475, pt .5596, pr:t 2.3802. With t fixed p is p + pt / 3
  // (3.5); a contribution to the variance is 2 / 3 of the variance of t and of pt.
  const auto r = generalizability(syntheticFour());
  ASSERT_TRUE(r) << r.reason();
  EXPECT_NEAR(r->person, 0.6475, 5e-5);
  EXPECT_NEAR(r->residual, 2.3802, 5e-5);
  EXPECT_NEAR(r->common, 0.4731 + 0.5596 / 3.0, 1e-4);
  EXPECT_NEAR(r->interaction, 0.5596 * 2.0 / 3.0, 5e-5);
  EXPECT_NEAR(r->group, 0.3252 * 2.0 / 3.0, 5e-5);
  EXPECT_NEAR(r->facet, 0.4731 + 0.5596, 1e-4);
  EXPECT_FALSE(r->truncated);
  const auto s = levelShares(syntheticFour());
  ASSERT_TRUE(s) << s.reason();
  const double total = r->person + r->facet + r->residual;
  EXPECT_NEAR(s->level.value, 1.0 - r->person / total, 1e-14);
  EXPECT_NEAR(s->common.value + s->interaction.value + s->residual.value, s->level.value, 1e-14);
  EXPECT_EQ(s->level.interval->lower, levelShares(syntheticFour())->level.interval->lower) << "one seed, one interval";
}

/// What was planted in a figure of people nested in groups with levels that change it.
struct Planted {
  std::size_t people = 20, levels = 4;
  double person = 1.0, common = 0.2, interaction = 0.1, residual = 0.3, group = 0.5;  ///< deviations

  /// With effects whose sample variances are the planted ones, so that they are the truth of the levels at hand.
  [[nodiscard]] std::vector<RatingTable> draw(RandomStream& random) const {
    std::vector<RatingTable> tables;
    for (const double side : {-1.0, 1.0}) {
      RatingTable table{people, levels, {}};
      for (std::size_t i = 0; i < people; ++i) {
        const double worth = side * group + person * random.normal();
        for (std::size_t j = 0; j < levels; ++j) {
          const double even = j % 2 == 0 ? 1.0 : -1.0, half = j < levels / 2 ? 1.0 : -1.0;
          const double scale = std::sqrt(static_cast<double>(levels - 1) / static_cast<double>(levels));
          table.values.push_back(worth + scale * (common * even + side * interaction * half) +
                                 residual * random.normal());
        }
      }
      tables.push_back(table);
    }
    return tables;
  }
};

TEST(Generalizability, findsPlantedComponentsOfPeopleInGroups) {
  constexpr std::uint64_t seed = 11;
  constexpr int studies = 2000;
  SCOPED_TRACE(seed);
  RandomStream random(seed);
  const Planted planted{};
  // Means over the studies, of estimates that are hardly ever cut off at 0.
  double person = 0.0, common = 0.0, interaction = 0.0, residual = 0.0, group = 0.0;
  for (int i = 0; i < studies; ++i) {
    const auto r = generalizability(planted.draw(random));
    person += r->person / studies;
    common += r->common / studies;
    interaction += r->interaction / studies;
    residual += r->residual / studies;
    group += r->group / studies;
  }
  // Four standard errors: of one study the deviations are 0.23, 0.011, 0.006, 0.012, 0.16.
  EXPECT_NEAR(person, 1.0, 0.021);
  EXPECT_NEAR(common, 0.04, 0.001);
  EXPECT_NEAR(interaction, 0.01, 0.0006);
  EXPECT_NEAR(residual, 0.09, 0.0011);
  EXPECT_NEAR(group, 0.25, 0.015);
}

TEST(Generalizability, intervalsOfSharesCover) {
  constexpr std::uint64_t seed = 12;
  constexpr int studies = 300;
  SCOPED_TRACE(seed);
  RandomStream random(seed);
  const Planted planted{};
  const double level = 0.04 + 0.01 + 0.09, truth = level / (1.0 + level);
  int covered = 0;
  for (int i = 0; i < studies; ++i) {
    const auto s = levelShares(planted.draw(random), {.resamples = 499, .seed = 1});
    covered += s->level.interval->lower <= truth && truth <= s->level.interval->upper ? 1 : 0;
  }
  // 0.918 of 4000 with another seed; three deviations of 300 are 0.048.
  EXPECT_NEAR(covered / static_cast<double>(studies), 0.918, 0.048);
}

/// Groups of different sizes, and one in which a figure is always the same.
TEST(Generalizability, ofUnequalGroups) {
  RandomStream random(13);
  std::vector<RatingTable> tables{{400, 3, {}}, {200, 3, {}}};
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t i = 0; i < tables[g].subjects; ++i) {
      const double worth = random.normal();
      for (const double level : {-0.5, 0.0, 0.5}) tables[g].values.push_back(worth + level + 0.5 * random.normal());
    }
  }
  const auto r = generalizability(tables);
  EXPECT_NEAR(r->common, 0.25, 0.03);
  EXPECT_NEAR(r->interaction, 0.0, 0.01);
  EXPECT_NEAR(r->person, 1.0, 0.15);
  const RatingTable still{400, 3, std::vector<double>(1200, 2.5)};
  const std::vector<RatingTable> half{tables[0], still};
  const auto h = generalizability(half), one = generalizability(tables[0]);
  ASSERT_TRUE(h) << h.reason();
  EXPECT_NEAR(h->person, one->person / 2.0, 1e-12);
  EXPECT_NEAR(h->residual, one->residual / 2.0, 1e-12);
  EXPECT_NEAR(h->facet, one->facet / 2.0, 1e-12);
  EXPECT_NEAR(h->common, h->interaction, 0.01) << "a level changes one group alone: half of it is common";
  const std::vector<RatingTable> equal{still, still};
  EXPECT_FALSE(levelShares(equal));
}

TEST(Generalizability, findsPlantedComponents) {
  RandomStream random(5);
  RatingTable table{4000, 12, {}};
  std::vector<double> lenient(12);
  double ofLeniency = 0.0, sum = 0.0;
  for (double& l : lenient) {
    l = 0.5 * random.normal();
    sum += l / 12.0;
  }
  for (const double l : lenient) ofLeniency += (l - sum) * (l - sum) / 11.0;
  for (std::size_t i = 0; i < table.subjects; ++i) {
    const double worth = 2.0 * random.normal();
    for (const double l : lenient) table.values.push_back(worth + l + random.normal());
  }
  const auto r = generalizability(table);
  EXPECT_NEAR(r->person, 4.0, 0.4);
  EXPECT_NEAR(r->facet, ofLeniency, 0.02);
  EXPECT_NEAR(r->residual, 1.0, 0.03);
}

TEST(Generalizability, negativeComponentsAreNone) {
  // People alike, raters alike, and all of it interaction.
  const auto r = generalizability({2, 2, {1, 2, 2, 1}});
  ASSERT_TRUE(r) << r.reason();
  EXPECT_TRUE(r->truncated);
  EXPECT_DOUBLE_EQ(r->person, 0.0);
  EXPECT_DOUBLE_EQ(r->at(3).g, 0.0);
  EXPECT_EQ(generalizability({2, 2, {1, 1, 1, 1}}).reason(), objection({2, 2, {1, 1, 1, 1}}));
  EXPECT_FALSE(generalizability({2, 2, {1, 1, 1, 1}}));
}

TEST(MeasurementError, ofR) {
  // R 4.2.2: sigma(lm(distance ~ Subject, Orthodont)) with eight visits missing; s sqrt(73 / qchisq(c(.975, .025),
  // 73)).
  const std::set<std::pair<std::size_t, std::size_t>> missing{{11, 1}, {11, 2}, {12, 2}, {23, 1},
                                                              {23, 2}, {23, 3}, {8, 2},  {10, 1}};
  std::vector<RepeatedValue> values;
  for (std::size_t child = 0; child < 27; ++child) {
    for (std::size_t visit = 0; visit < 4; ++visit) {
      if (missing.count({child, visit}) == 0)
        values.push_back({child, static_cast<double>(visit), data::distance[4 * child + visit]});
    }
  }
  const auto r = measurementError(values);
  ASSERT_TRUE(r) << r.reason();
  EXPECT_DOUBLE_EQ(r->df, 73.0);
  EXPECT_EQ(r->people, 26U);  // one has a single visit
  EXPECT_NEAR(r->sem, 2.03423888810564, 1e-12);
  EXPECT_NEAR(r->sdc, 5.63851890933289, 1e-12);
  EXPECT_NEAR(r->semInterval.lower, 1.7510938384101, 1e-12);
  EXPECT_NEAR(r->semInterval.upper, 2.4274690002923, 1e-12);
  EXPECT_NEAR(r->sdcInterval.upper / r->semInterval.upper, r->sdc / r->sem, 1e-13);
}

TEST(MeasurementError, refuses) {
  expectNames(measurementError({}).reason(), {});
  const std::vector<RepeatedValue> equal{{0, 0, 3.0}, {0, 1, 3.0}, {1, 0, 5.0}};
  expectNames(measurementError(equal).reason(), {});
}

}  // namespace
}  // namespace calot::analytics

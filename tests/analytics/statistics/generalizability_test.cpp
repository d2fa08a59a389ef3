// SPDX-License-Identifier: GPL-3.0-or-later
// Variance components of a crossed facet, and the error of measurement.
#include "analytics/statistics/reliability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

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

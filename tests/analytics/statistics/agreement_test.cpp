// SPDX-License-Identifier: GPL-3.0-or-later
// Intraclass correlation and Cronbach's alpha.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analytics/statistics/reliability.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

const RatingTable judges{6, 4, data::shroutFleiss};

TEST(IntraclassCorrelation, threeOfShroutAndFleiss) {
  // psych 2.2.9 on R 4.2.2: ICC(table, lmer = FALSE). Published: .29, .62, .91.
  struct Row {
    IccForm form;
    double value, lower, upper;
  };
  for (const Row& r : {Row{IccForm::twoSingle, .28976377952756, .018786513374712, .76108436964895},
                       Row{IccForm::twoAverage, .62005054759899, .071136815302503, .92723204016772},
                       Row{IccForm::threeAverage, .90931554237707, .675674713816305, .98589167816906}}) {
    SCOPED_TRACE(nameOf(r.form));
    const auto icc = intraclassCorrelation(judges, r.form);
    ASSERT_TRUE(icc) << icc.reason();
    EXPECT_NEAR(icc->value, r.value, 5e-14);
    ASSERT_TRUE(icc->interval) << icc->interval.reason();
    EXPECT_NEAR(icc->interval->lower, r.lower, 5e-13);
    EXPECT_NEAR(icc->interval->upper, r.upper, 5e-13);
  }
  const auto two = intraclassCorrelation(judges, IccForm::twoSingle);
  EXPECT_NEAR(two->value, .2897637795, 5e-11);
  EXPECT_NEAR(two->interval->lower, .0187865, 5e-8);
  EXPECT_NEAR(two->interval->upper, .7610844, 5e-8);
}

TEST(IntraclassCorrelation, isFreeOfUnitAndBlindToWhatItsFormAllows) {
  RatingTable other = judges;
  for (double& v : other.values) v = 100.0 - 7.0 * v;
  for (const IccForm form : {IccForm::twoSingle, IccForm::twoAverage, IccForm::threeAverage})
    EXPECT_NEAR(intraclassCorrelation(other, form)->value, intraclassCorrelation(judges, form)->value, 1e-12);
  // A rater's leniency: ICC(3,.) does not see it, ICC(2,.) does.
  RatingTable lenient = judges;
  for (std::size_t i = 0; i < 6; ++i) lenient.values[i * 4 + 2] += 20.0;
  EXPECT_NEAR(intraclassCorrelation(lenient, IccForm::threeAverage)->value, .90931554237707, 5e-14);
  EXPECT_LT(intraclassCorrelation(lenient, IccForm::twoSingle)->value, 0.1);
}

TEST(IntraclassCorrelation, degenerate) {
  const auto reason = [](const RatingTable& t, IccForm f) { return intraclassCorrelation(t, f).reason(); };
  expectDistinct({reason({1, 3, {1, 2, 3}}, IccForm::twoSingle), reason({3, 1, {1, 2, 3}}, IccForm::twoSingle),
                  reason({2, 2, {1, 2, 3}}, IccForm::twoSingle), reason({2, 2, {1, 2, 3, NAN}}, IccForm::twoSingle),
                  reason({2, 2, {4, 4, 4, 4}}, IccForm::twoSingle)});
  // Only the raters differ: nothing to tell subjects apart by.
  expectNames(reason({3, 2, {1, 2, 1, 2, 1, 2}}, IccForm::threeAverage), {});
  const auto perfect = intraclassCorrelation({3, 2, {1, 1, 2, 2, 5, 5}}, IccForm::twoSingle);
  ASSERT_TRUE(perfect);
  EXPECT_DOUBLE_EQ(perfect->value, 1.0);
  expectNames(perfect->interval.reason(), {});
  const auto shifted = intraclassCorrelation({3, 2, {1.1, 2.2, 2.1, 3.2, 5.1, 6.2}}, IccForm::threeAverage);
  EXPECT_DOUBLE_EQ(shifted->value, 1.0);
  expectNames(shifted->interval.reason(), {});
}

TEST(IntraclassCorrelation, noInputGivesANan) {
  const unsigned seed = 1979;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 3000; ++round) {
    RatingTable t;
    t.subjects = 2 + random() % 3;
    t.raters = 2 + random() % 3;
    const auto levels = 2 + random() % 3;
    for (std::size_t i = 0; i < t.subjects * t.raters; ++i)
      t.values.push_back(static_cast<double>(random() % levels) * 0.1);
    for (const IccForm form : {IccForm::twoSingle, IccForm::twoAverage, IccForm::threeAverage}) {
      const auto icc = intraclassCorrelation(t, form);
      if (!icc) continue;
      ASSERT_TRUE(std::isfinite(icc->value)) << nameOf(form);
      if (icc->interval) {
        ASSERT_TRUE(std::isfinite(icc->interval->lower) && std::isfinite(icc->interval->upper)) << nameOf(form);
        ASSERT_LE(icc->interval->lower, icc->interval->upper) << nameOf(form);
      }
    }
  }
}

TEST(CronbachAlpha, publishedTables) {
  const auto judgesAlpha = cronbachAlpha(judges);
  ASSERT_TRUE(judgesAlpha) << judgesAlpha.reason();
  EXPECT_NEAR(judgesAlpha->value, .9093155424, 5e-11);
  // psych 2.2.9: alpha.ci(.90931554237707, 6, 4).
  EXPECT_NEAR(judgesAlpha->interval->lower, .675674713816, 5e-13);
  EXPECT_NEAR(judgesAlpha->interval->upper, .985891678169, 5e-13);
  // psych 2.2.9: alpha(attitude), alpha.ci(alpha, 30, 7).
  const auto attitude = cronbachAlpha({30, 7, data::attitude});
  EXPECT_NEAR(attitude->value, .84314277, 5e-9);
  EXPECT_NEAR(attitude->value, .843142769565, 5e-13);
  EXPECT_NEAR(attitude->interval->lower, .739375685643, 5e-13);
  EXPECT_NEAR(attitude->interval->upper, .91577307216, 5e-12);
}

TEST(CronbachAlpha, degenerate) {
  expectDistinct({cronbachAlpha({3, 2, {1, 2, 3, 4, 5, 6}}).reason(), cronbachAlpha({1, 3, {1, 2, 3}}).reason(),
                  cronbachAlpha({2, 3, {2, 2, 2, 2, 2, 2}}).reason(),
                  cronbachAlpha({2, 3, {1, 2, 3, 3, 2, 1}}).reason()});
  const auto perfect = cronbachAlpha({3, 3, {1, 1, 1, 4, 4, 4, 2, 2, 2}});
  EXPECT_DOUBLE_EQ(perfect->value, 1.0);
  expectNames(perfect->interval.reason(), {});
}

}  // namespace
}  // namespace calot::analytics

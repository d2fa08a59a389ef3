// SPDX-License-Identifier: GPL-3.0-or-later
// A, the area under the ROC curve, and its interval.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analytics/statistics/two_groups.h"
#include "tests/analytics/statistics/support/published_data.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

const Values low{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, high{11, 12, 13, 14, 15, 16, 17, 18, 19, 20};

TEST(Superiority, scoreOfASah) {
  // R 4.2.2, uniroot on Newcombe's equation, 41 and 72 people.
  const auto score = estimateSuperiority(data::s100bPoor, data::s100bGood, Hypothesis::firstLarger);
  ASSERT_TRUE(score) << score.reason();
  EXPECT_EQ(score->a.method, "score");
  EXPECT_NEAR(score->a.lower, 0.624407596221115, 1e-12);
  EXPECT_NEAR(score->a.upper, 0.813953296926986, 1e-12);
  EXPECT_NEAR(score->delta.lower, 2 * 0.624407596221115 - 1, 1e-12);
}

TEST(Superiority, directionIsTheHypothesisNotTheData) {
  // A below one half stays below: the data speak against the hypothesis.
  const auto as = estimateSuperiority(data::sleep1, data::sleep2, Hypothesis::firstLarger);
  EXPECT_NEAR(as->value.a, 0.255, 1e-15);
  EXPECT_NEAR(as->a.lower, 0.105912175273908, 1e-12);
  EXPECT_NEAR(as->a.upper, 0.514155155114684, 1e-12);
  const auto against = estimateSuperiority(data::sleep1, data::sleep2, Hypothesis::firstSmaller);
  EXPECT_NEAR(against->value.a, 0.745, 1e-15);
  EXPECT_NEAR(against->value.delta, 0.49, 1e-15);
  EXPECT_NEAR(against->a.lower, 1.0 - as->a.upper, 1e-12);
  EXPECT_NEAR(against->a.upper, 1.0 - as->a.lower, 1e-12);
}

TEST(Superiority, completeSeparationKeepsAnInterval) {
  // R 4.2.2: uniroot of (1 - t)^2 = z^2 t (1 - t) (1 + 9 ((1 - t) / (2 - t) + t / (1 + t))) / 100.
  const auto s = estimateSuperiority(high, low, Hypothesis::firstLarger);
  ASSERT_TRUE(s);
  EXPECT_DOUBLE_EQ(s->value.a, 1.0);
  EXPECT_NEAR(s->a.lower, 0.800213612881106, 1e-10);
  EXPECT_DOUBLE_EQ(s->a.upper, 1.0);
  EXPECT_DOUBLE_EQ(estimateSuperiority(low, high, Hypothesis::firstLarger)->a.lower, 0.0);
  EXPECT_NEAR(estimateSuperiority(low, high, Hypothesis::firstLarger)->a.upper, 1.0 - 0.800213612881106, 1e-10);
}

TEST(Superiority, scoreEndsSolveTheirEquation) {
  const unsigned seed = 2006;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const double z = 1.959963984540054;
  for (int round = 0; round < 200; ++round) {
    Values x(1 + random() % 12), y(1 + random() % 12);
    for (double& v : x) v = static_cast<double>(random() % 9);
    for (double& v : y) v = static_cast<double>(random() % 9);
    const auto s = estimateSuperiority(x, y, Hypothesis::firstLarger);
    if (!s) {
      expectNames(s.reason(), {});
      continue;
    }
    const double n = static_cast<double>(x.size() * y.size()),
                 extra = static_cast<double>(x.size() + y.size()) / 2.0 - 1.0;
    for (const double t : {s->a.lower, s->a.upper}) {
      ASSERT_GE(t, 0.0);
      ASSERT_LE(t, 1.0);
      if (t == 0.0 || t == 1.0) continue;
      const double spread = t * (1 - t) * (1 + extra * ((1 - t) / (2 - t) + t / (1 + t))) / n;
      EXPECT_NEAR((s->value.a - t) * (s->value.a - t), z * z * spread, 1e-9);
    }
    EXPECT_LE(s->a.lower, s->value.a);
    EXPECT_GE(s->a.upper, s->value.a);
  }
}

TEST(Superiority, degenerate) {
  expectDistinct({estimateSuperiority(Values{}, low, Hypothesis::firstSmaller).reason(),
                  estimateSuperiority(low, Values{}, Hypothesis::firstSmaller).reason(),
                  estimateSuperiority(Values{3, 3}, Values{3}, Hypothesis::firstLarger).reason()});
}

}  // namespace
}  // namespace calot::analytics

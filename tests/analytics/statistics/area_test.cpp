// SPDX-License-Identifier: GPL-3.0-or-later
// A, the area under the ROC curve: DeLong's variance, intervals, paired comparison.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analytics/statistics/delong.h"
#include "analytics/statistics/effect_sizes.h"
#include "tests/analytics/statistics/support/published_data.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

const Values low{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, high{11, 12, 13, 14, 15, 16, 17, 18, 19, 20};

/// The components are those of every pair, to the last bit.
TEST(DeLong, componentsAreCountsOfPairs) {
  const unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 100; ++round) {
    Values x(2 + random() % 30), y(2 + random() % 30);
    const unsigned span = round % 2 == 0 ? 8 : 100000;  // many ties, or hardly any
    for (double& v : x) v = static_cast<double>(random() % span);
    for (double& v : y) v = static_cast<double>(random() % span);
    Values ofX(x.size(), 0.0), ofY(y.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < y.size(); ++j) {
        const double psi = x[i] > y[j] ? 1.0 : x[i] == y[j] ? 0.5 : 0.0;
        ofX[i] += psi;
        ofY[j] += psi;
      }
    }
    for (double& v : ofX) v /= static_cast<double>(y.size());
    for (double& v : ofY) v /= static_cast<double>(x.size());
    const auto d = deLong(x, y);
    ASSERT_TRUE(d) << d.reason();
    EXPECT_EQ(d->ofX, ofX);
    EXPECT_EQ(d->ofY, ofY);
  }
}

TEST(DeLong, aSah) {
  // pROC 1.18.0: auc, var of roc(aSAH$outcome, aSAH$s100b, direction = "<").
  const auto d = deLong(data::s100bPoor, data::s100bGood);
  ASSERT_TRUE(d) << d.reason();
  EXPECT_NEAR(d->a, 0.731368563686, 5e-13);
  EXPECT_NEAR(d->variance, 0.00266868245717, 5e-15);
  EXPECT_NEAR(deLong(data::ndkaPoor, data::ndkaGood)->a, 0.611957994580, 5e-13);
  EXPECT_NEAR(deLong(data::wfnsPoor, data::wfnsGood)->a, 0.823678861789, 5e-13);
  EXPECT_NEAR(deLong(data::wfnsPoor, data::wfnsGood)->variance, 0.00146991470882363, 5e-17);
}

TEST(DeLong, pairedAreasOfASah) {
  // pROC 1.18.0: roc.test(s100b, wfns, method = "delong", paired = TRUE), and with ndka.
  const auto c = compareAreas({data::s100bPoor, data::wfnsPoor, data::s100bGood, data::wfnsGood});
  ASSERT_TRUE(c) << c.reason();
  EXPECT_EQ(c->method, "DeLong");
  EXPECT_NEAR(*c->z, -2.2089835914, 5e-11);
  EXPECT_NEAR(c->p, 0.0271757822, 5e-11);
  EXPECT_NEAR(c->interval->lower, -0.1742144192495, 5e-14);
  EXPECT_NEAR(c->interval->upper, -0.0104061769565, 5e-14);
  const auto n = compareAreas({data::s100bPoor, data::ndkaPoor, data::s100bGood, data::ndkaGood});
  EXPECT_NEAR(*n->z, 1.390770025735577, 1e-13);
  EXPECT_NEAR(n->p, 0.164295175223054, 1e-13);
}

TEST(DeLong, fallsBackWhereItsVarianceVanishes) {
  // The first figure separates completely. All 2^6 exchanges of six people's ranks, gone through here by hand.
  const Values x1{7, 8, 9}, y1{1, 2, 3}, x2{3, 8, 9}, y2{1, 5, 7};
  const auto c = compareAreas({x1, x2, y1, y2});
  ASSERT_TRUE(c) << c.reason();
  EXPECT_DOUBLE_EQ(c->first, 1.0);
  EXPECT_FALSE(c->z);
  EXPECT_FALSE(c->interval);
  EXPECT_NE(c->method.find("all exchanges, since DeLong's variance vanishes"), std::string::npos) << c->method;
  // Ranks of the first figure 4 5 6 | 1 2 3, of the second 2 5 6 | 1 3 4: persons 1, 5 and 6 differ.
  const Values first{4, 5, 6, 1, 2, 3}, second{2, 5, 6, 1, 3, 4};
  const auto area = [](const Values& r) {
    double wins = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 3; j < 6; ++j) wins += r[i] > r[j] ? 1.0 : r[i] == r[j] ? 0.5 : 0.0;
    }
    return wins / 9.0;
  };
  int hits = 0;
  for (unsigned set = 0; set < 64; ++set) {
    Values a = first, b = second;
    for (std::size_t i = 0; i < 6; ++i) {
      if ((set >> i & 1U) != 0) std::swap(a[i], b[i]);
    }
    if (std::abs(area(a) - area(b)) >= std::abs(area(first) - area(second)) - 1e-12) ++hits;
  }
  EXPECT_NEAR(c->p, hits / 64.0, 1e-15);
  // Twenty people: at random, with a seed.
  Values mixed = low;
  std::swap(mixed[9], mixed[0]);
  Values mixedHigh = high;
  mixedHigh[0] = 0.5;
  const auto many = compareAreas({high, mixedHigh, low, mixed}, 0.95, 5);
  EXPECT_EQ(many->seed, 5U);
  EXPECT_NE(many->method.find("random"), std::string::npos);
  EXPECT_GT(many->p, 0.0);
}

TEST(DeLong, degenerate) {
  EXPECT_EQ(deLong(Values{1}, Values{1, 2}).reason(), "a group of one value has no variance");
  EXPECT_EQ(deLong(Values{}, Values{1, 2}).reason(), "the first group is empty");
  EXPECT_EQ(compareAreas({high, high, low, low}).reason(), "the two figures rank everybody alike");
  EXPECT_EQ(compareAreas({high, Values{1.0}, low, low}).reason(), "the two figures are not of the same people");
}

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
      EXPECT_EQ(s.reason(), "all values are equal");
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
  EXPECT_EQ(estimateSuperiority(Values{}, low, Hypothesis::firstSmaller).reason(), "the first group is empty");
  EXPECT_EQ(estimateSuperiority(low, Values{}, Hypothesis::firstSmaller).reason(), "the second group is empty");
  EXPECT_EQ(estimateSuperiority(Values{3, 3}, Values{3}, Hypothesis::firstLarger).reason(), "all values are equal");
}

}  // namespace
}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/power.h"

#include <gtest/gtest.h>

#include <cmath>
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

/// Four standard errors of a simulated share.
double chance(double p, std::size_t n) { return 4.0 * std::sqrt(p * (1.0 - p) / static_cast<double>(n)); }

TEST(Power, withoutAnEffectItIsTheAttainedLevel) {
  // Ten against ten: U <= 23 or >= 77, .0432570525.
  PowerPlan plan;
  plan.checkpoints = shifts({0.0});
  const auto power = simulatePower(plan);
  ASSERT_TRUE(power) << power.reason();
  EXPECT_NEAR(power->ofCheckpoint[0].value, 0.0432570525, chance(0.0433, plan.simulations));
  EXPECT_EQ(power->seed, 1U);
  EXPECT_DOUBLE_EQ(power->anyEffect.value, 0.0);
}

TEST(Power, rejectsAtTheLevelItself) {
  // Three against three: only complete separation reaches p = 2 / 20, which is the level.
  PowerPlan plan;
  plan.nx = plan.ny = 3;
  plan.checkpoints = shifts({0.0});
  plan.level = 0.1;
  EXPECT_NEAR(simulatePower(plan)->ofCheckpoint[0].value, 0.1, chance(0.1, plan.simulations));
  plan.level = 0.0999;
  EXPECT_DOUBLE_EQ(simulatePower(plan)->ofCheckpoint[0].value, 0.0);
}

TEST(Power, agreesWithAnIndependentSimulation) {
  // R 4.2.2: set.seed(1); mean(replicate(200000, {u <- sum(outer(rnorm(10, 1.5), rnorm(10), ">")); u <= 23 || u >=
  // 77})) is 0.85184; for normal groups a little below Student's .887 (power.t.test(n = 10, delta = 1.5)).
  PowerPlan plan;
  plan.checkpoints = shifts({1.5});
  plan.simulations = 40000;
  const auto power = simulatePower(plan);
  EXPECT_NEAR(power->ofCheckpoint[0].value, 0.85184, chance(0.85, plan.simulations));
  EXPECT_LT(power->ofCheckpoint[0].interval.lower, power->ofCheckpoint[0].value);
  // A rank test sees no more of the lognormal than of the normal: same draws, same answer.
  plan.shape = PowerShape::lognormal;
  EXPECT_DOUBLE_EQ(simulatePower(plan)->ofCheckpoint[0].value, power->ofCheckpoint[0].value);
}

TEST(Power, holmHoldsTheFamilyAndCostsPower) {
  PowerPlan plan;
  plan.checkpoints = shifts({1.2, 0.0, 0.0, 0.0});
  plan.adjustment = Adjustment::none;
  const auto plain = simulatePower(plan);
  plan.adjustment = Adjustment::holm;
  const auto holm = simulatePower(plan);
  plan.adjustment = Adjustment::benjaminiHochberg;
  const auto bh = simulatePower(plan);
  EXPECT_LT(holm->ofCheckpoint[0].value, plain->ofCheckpoint[0].value - 0.1);
  EXPECT_GE(bh->ofCheckpoint[0].value, holm->ofCheckpoint[0].value);
  // Three true hypotheses under Holm: each falsely rejected in at most 5 % / 3 or so once the effect is out of the way.
  EXPECT_LT(holm->ofCheckpoint[1].value, 0.0175);
  EXPECT_DOUBLE_EQ(holm->anyEffect.value, holm->ofCheckpoint[0].value);
  EXPECT_DOUBLE_EQ(holm->allEffects.value, holm->ofCheckpoint[0].value);
}

TEST(Power, correlatedCheckpointsFallTogether) {
  PowerPlan plan;
  plan.checkpoints = shifts({1.0, 1.0, 1.0});
  plan.simulations = 4000;
  const auto alone = simulatePower(plan);
  plan.correlation = 0.9;
  const auto together = simulatePower(plan);
  EXPECT_LT(together->anyEffect.value, alone->anyEffect.value);
  EXPECT_GT(together->allEffects.value, alone->allEffects.value);
}

TEST(Power, tiesAndTestsWithoutAnAnswer) {
  PowerPlan plan;
  plan.nx = plan.ny = 4;
  plan.checkpoints = shifts({0.0});
  plan.step = 100.0;  // everything rounds to 0
  plan.simulations = 50;
  const auto power = simulatePower(plan);
  EXPECT_EQ(power->untestable, 50U);
  EXPECT_DOUBLE_EQ(power->ofCheckpoint[0].value, 0.0);
  plan.step = 1.0;
  plan.nx = plan.ny = 10;
  plan.checkpoints = shifts({2.0});
  plan.simulations = 2000;
  EXPECT_GT(simulatePower(plan)->ofCheckpoint[0].value, 0.9);
}

TEST(Power, isExactWhereItCanBeCalculated) {
  // Three against three at .1 are rejected by complete separation alone. x is 0 or 2 with chances 3/4 and 1/4 and y is
  // always 1: separated where all three x agree.
  PowerPlan plan;
  plan.nx = plan.ny = 3;
  plan.level = 0.1;
  plan.simulations = 40000;
  plan.population.emplace();
  plan.population->people[0] = {{0.0}, {0.0}, {0.0}, {2.0}};
  plan.population->people[1] = {{1.0}};
  const double separated = std::pow(0.75, 3) + std::pow(0.25, 3);
  const auto power = simulatePower(plan);
  ASSERT_TRUE(power) << power.reason();
  EXPECT_NEAR(power->ofCheckpoint[0].value, separated, chance(separated, plan.simulations));
  EXPECT_EQ(power->ofCheckpoint[0].interval.method, "Wilson");
}

TEST(Power, agreesWithRWhereTheSpreadsDiffer) {
  // R 4.2.2: set.seed(1); mean(replicate(200000, {u <- sum(outer(rnorm(8, 1.2, 2), rnorm(12), ">")); u <= 22 || u >=
  // 74})) is 0.343755; qwilcox(.025, 8, 12) is 23, so that 22 is the largest U whose two-sided p is at most 5 %.
  PowerPlan plan;
  plan.nx = 8;
  plan.ny = 12;
  plan.checkpoints = {{{1.2, 2.0}, {0.0, 1.0}}};
  plan.simulations = 40000;
  EXPECT_NEAR(simulatePower(plan)->ofCheckpoint[0].value, 0.343755, chance(0.343755, plan.simulations));
}

TEST(Power, drawsPeopleWholeAndKeepsWhatIsMissing) {
  // The second figure is the first one's double: both are rejected together, or neither is.
  PowerPlan plan;
  plan.simulations = 2000;
  plan.adjustment = Adjustment::none;
  plan.population.emplace();
  for (int i = 0; i < 6; ++i) {
    plan.population->people[0].push_back({1.0 * i, 2.0 * i});
    plan.population->people[1].push_back({1.0 * i + 2.5, 2.0 * i + 5.0});
  }
  const auto both = simulatePower(plan);
  EXPECT_DOUBLE_EQ(both->anyEffect.value, both->allEffects.value);
  EXPECT_GT(both->anyEffect.value, 0.2);
  // Nobody of y has the second one: never tested, and under Holm still in the family.
  for (auto& person : plan.population->people[1]) person[1].reset();
  plan.adjustment = Adjustment::holm;
  const auto missing = simulatePower(plan);
  EXPECT_EQ(missing->untestable, plan.simulations);
  EXPECT_DOUBLE_EQ(missing->ofCheckpoint[1].value, 0.0);
  EXPECT_LT(missing->ofCheckpoint[0].value, both->ofCheckpoint[0].value);
}

TEST(Power, refusals) {
  const auto reason = [](auto change) {
    PowerPlan plan;
    change(plan);
    return simulatePower(plan).reason();
  };
  expectDistinct({reason([](PowerPlan& p) { p.nx = 0; }), reason([](PowerPlan& p) { p.checkpoints.clear(); }),
                  reason([](PowerPlan& p) { p.checkpoints = shifts({NAN}); }),
                  reason([](PowerPlan& p) { p.checkpoints[0].x.deviation = 0.0; }),
                  reason([](PowerPlan& p) { p.population.emplace(); })});
  expectNames(reason([](PowerPlan& p) {
                p.population.emplace();
                p.population->people[0] = {{1.0}};
                p.population->people[1] = {{1.0, 2.0}};
              }),
              {});
  expectDistinct({reason([](PowerPlan& p) { p.correlation = 1.0; }), reason([](PowerPlan& p) { p.level = 0.0; }),
                  reason([](PowerPlan& p) { p.step = -1.0; }), reason([](PowerPlan& p) { p.simulations = 0; })});
}

}  // namespace
}  // namespace calot::analytics

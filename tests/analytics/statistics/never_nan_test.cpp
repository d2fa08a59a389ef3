// SPDX-License-Identifier: GPL-3.0-or-later
// Small, tied, empty, constant, huge and tiny input for everything: an answer is finite, or there is a reason.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/mixed_models.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/regression.h"
#include "analytics/statistics/reliability.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/standard_setting.h"
#include "analytics/statistics/survival.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

using Values = std::vector<double>;

class NeverNan : public testing::Test {
 protected:
  /// An answer whose numbers are finite, or a reason.
  template <class T, class Numbers>
  void check(const char* what, const Expected<T>& answer, const Numbers& numbers) {
    if (!answer) {
      EXPECT_FALSE(answer.reason().empty()) << what << where_;
      ++reasons_;
      return;
    }
    ++answers_;
    for (const double v : numbers(*answer)) EXPECT_TRUE(std::isfinite(v)) << what << where_;
  }
  void checkInterval(const char* what, const Expected<Interval>& interval) {
    check(what, interval, [](const Interval& i) { return Values{i.lower, i.upper}; });
    if (interval) {
      EXPECT_LE(interval->lower, interval->upper) << what << where_;
    }
  }

  void twoGroups(const Values& x, const Values& y) {
    check("mannWhitney", mannWhitney(x, y), [](const MannWhitney& t) { return Values{t.u, t.p}; });
    check("asymptotic", mannWhitney(x, y, RankTest::asymptotic), [](const MannWhitney& t) { return Values{t.u, t.p}; });
    check("shift", hodgesLehmann(x, y), [](double v) { return Values{v}; });
    check("shift's interval", hodgesLehmannInterval(x, y, 0.8), [](const ShiftInterval& i) {
      return Values{i.lower, i.upper, i.attained};
    });
    const auto g = hedgesG(x, y);
    check("g", g, [](const HedgesG& h) { return Values{h.g, h.d, h.j}; });
    if (g) checkInterval("g's interval", g->interval);
    check("A", estimateSuperiority(x, y, Hypothesis::firstSmaller), [](const SuperiorityEstimate& e) {
      return Values{e.value.a, e.a.lower, e.a.upper, e.delta.lower, e.delta.upper};
    });
    const std::vector<Values> groups{x, y};
    check("kruskalWallis", kruskalWallis(groups), [](const KruskalWallis& k) { return Values{k.h, k.p}; });
    check("dunn", dunn(groups), [](const std::vector<DunnPair>& d) { return Values{d[0].z, d[0].p, d[0].adjusted}; });
    const std::vector<Stratum> strata{{x, y}, {y, x}};
    check("stratified", stratifiedRankSum(strata), [](const StratifiedRankSum& s) { return Values{s.z, s.p, s.a}; });
    ContrastingGroupsOptions few;
    few.resamples = 99;
    const auto cut = contrastingGroups(x, y, Better::higher, few);
    check("cut", cut, [](const ContrastingGroups& c) { return Values{c.cut}; });
    if (cut) checkInterval("the cut's interval", cut->interval);
    BootstrapOptions resampling;
    resampling.resamples = 99;
    check(
        "bootstrap",
        bootstrap(
            x, y,
            [](std::span<const double> a, std::span<const double> b) { return Expected<double>(*mean(a) - *mean(b)); },
            resampling),
        [](const Bootstrap& b) {
          return Values{b.interval.lower, b.interval.upper};
        });
  }

  void series(const Values& x, const Values& y) {
    check("spearman", spearman(x, y), [](const Spearman& s) { return Values{s.rho, s.p}; });
    Values numbers;
    for (std::size_t i = 0; i < y.size(); ++i) numbers.push_back(1.0 + static_cast<double>(i));
    check("curve", fitLearningCurve(numbers, y), [](const LearningCurve& c) {
      return Values{c.plateau, c.gap, c.plateauError, c.gapError};
    });
    if (x.size() == y.size()) {
      const BaselineGroup a{x, y}, b{y, x};
      check("covariance", covarianceAnalysis(a, b), [](const CovarianceAnalysis& c) {
        return Values{c.estimate, c.error, c.t, c.p, c.slope, c.interval.lower, c.interval.upper};
      });
    }
    std::vector<CensoredTime> times, others;
    for (std::size_t i = 0; i < x.size(); ++i) times.push_back({x[i], i % 2 == 0});
    for (std::size_t i = 0; i < y.size(); ++i) others.push_back({y[i], i % 3 != 0});
    check("logRank", logRank(times, others), [](const LogRank& l) { return Values{l.z, l.p, l.variance}; });
    check("worstRank", worstRank(times, others, Hypothesis::firstSmaller), [](const WorstRank& w) {
      return Values{w.test.p, w.effect.a.lower, w.effect.a.upper};
    });
    std::vector<ModelAttempt> attempts;
    for (std::size_t i = 0; i < x.size(); ++i) attempts.push_back({i / 2, true, 0, x[i]});
    for (std::size_t i = 0; i < y.size(); ++i) attempts.push_back({100 + i / 2, false, 0, y[i]});
    check("randomIntercept", randomIntercept(attempts), [](const RandomIntercept& r) {
      return Values{r.estimate, r.error, r.t, r.p, r.betweenVariance, r.withinVariance, r.restrictedLogLikelihood};
    });
    if (y.size() % 3 == 0) {
      const auto alpha = cronbachAlpha({y.size() / 3, 3, y});
      check("alpha", alpha, [](const CronbachAlpha& c) { return Values{c.value}; });
      if (alpha) checkInterval("alpha's interval", alpha->interval);
    }
  }

  std::string where_;
  int answers_ = 0, reasons_ = 0;
};

TEST_F(NeverNan, whateverTheGroups) {
  const unsigned seed = 1947;
  std::mt19937 random(seed);
  for (int round = 0; round < 1500; ++round) {
    where_ = ", seed " + std::to_string(seed) + " round " + std::to_string(round);
    // Sizes 0 to 7, two to four levels, and every third round a great offset, a tiny or a huge unit.
    const auto levels = 1 + random() % 4;
    const double unit = round % 3 != 0 ? 1.0 : std::pow(10.0, static_cast<double>(random() % 25) - 12.0);
    const double offset = round % 5 == 0 ? 1e6 * unit : 0.0;
    Values x(random() % 8), y(random() % 8);
    for (double& v : x) v = offset + unit * 0.1 * static_cast<double>(random() % levels);
    for (double& v : y) v = offset + unit * 0.1 * static_cast<double>(random() % levels);
    twoGroups(x, y);
    series(x, y);
  }
  RecordProperty("answers", answers_);
  RecordProperty("reasons", reasons_);
  EXPECT_GT(answers_, 10000);
  EXPECT_GT(reasons_, 5000);
}

}  // namespace
}  // namespace calot::analytics

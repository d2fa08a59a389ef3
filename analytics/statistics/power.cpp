// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/power.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/multiplicity.h"
#include "analytics/statistics/random_stream.h"
#include "analytics/statistics/samples.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

std::string objection(const PowerPlan& plan) {
  if (plan.nx == 0 || plan.ny == 0) return "a group is empty";
  if (plan.effects.empty()) return "no checkpoint";
  if (!allFinite(plan.effects)) return "an effect is not finite";
  if (!(plan.correlation >= 0.0 && plan.correlation < 1.0)) return "the correlation is outside of [0, 1)";
  if (!(plan.step >= 0.0) || !std::isfinite(plan.step)) return "the step is negative";
  if (!(plan.level > 0.0 && plan.level < 1.0)) return "the level is not between 0 and 1";
  if (plan.simulations == 0) return "no simulations";
  return {};
}

/// mannWhitney(), which without ties depends on U alone: counted once for every U.
class RankTestOfSizes {
 public:
  Answer<double> p(const std::vector<double>& x, const std::vector<double>& y) {
    const bool ties = tieTerm(pooled(x, y)) > 0.0;
    if (!ties) {
      const double u = std::round(superiority(x, y)->a * static_cast<double>(x.size() * y.size()));
      const auto known = byU_.find(u);
      if (known != byU_.end()) return known->second;
      return byU_[u] = mannWhitney(x, y)->p;
    }
    const Answer<MannWhitney> test = mannWhitney(x, y);
    return test ? Answer<double>(test->p) : Answer<double>::none(test.reason());
  }

 private:
  std::map<double, double> byU_;
};

/// Values of one group, a vector a checkpoint.
std::vector<std::vector<double>> drawGroup(const PowerPlan& plan, std::size_t n, bool shifted, RandomStream& random) {
  std::vector<std::vector<double>> values(plan.effects.size(), std::vector<double>(n));
  const double common = std::sqrt(plan.correlation), own = std::sqrt(1.0 - plan.correlation);
  for (std::size_t i = 0; i < n; ++i) {
    const double factor = random.normal();
    for (std::size_t c = 0; c < values.size(); ++c) {
      double v = common * factor + own * random.normal() + (shifted ? plan.effects[c] : 0.0);
      if (plan.shape == PowerShape::lognormal) v = std::exp(v);
      if (plan.step > 0.0) v = std::round(v / plan.step) * plan.step;
      values[c][i] = v;
    }
  }
  return values;
}

std::vector<double> adjusted(const std::vector<double>& p, Adjustment adjustment) {
  if (adjustment == Adjustment::holm) return *holm(p);
  if (adjustment == Adjustment::benjaminiHochberg) return *benjaminiHochberg(p);
  return p;
}

SimulatedShare share(std::size_t hits, std::size_t of) {
  const double n = static_cast<double>(of), p = static_cast<double>(hits) / n, z = normalQuantile(0.975);
  const double centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {p, {std::max(0.0, centre - half), std::min(1.0, centre + half), 0.95, "Wilson"}};
}

}  // namespace

Answer<Power> simulatePower(const PowerPlan& plan) {
  if (const std::string reason = objection(plan); !reason.empty()) return Answer<Power>::none(reason);
  RandomStream random(plan.seed);
  RankTestOfSizes test;
  const std::size_t checkpoints = plan.effects.size();
  std::vector<std::size_t> rejected(checkpoints, 0);
  std::size_t any = 0, all = 0;
  Power power;
  for (std::size_t simulation = 0; simulation < plan.simulations; ++simulation) {
    const auto x = drawGroup(plan, plan.nx, true, random);
    const auto y = drawGroup(plan, plan.ny, false, random);
    std::vector<double> p(checkpoints, 1.0);
    for (std::size_t c = 0; c < checkpoints; ++c) {
      if (const Answer<double> answer = test.p(x[c], y[c])) {
        p[c] = *answer;
      } else {
        ++power.untestable;
      }
    }
    p = adjusted(p, plan.adjustment);
    std::size_t effects = 0, found = 0;
    for (std::size_t c = 0; c < checkpoints; ++c) {
      const bool hit = p[c] <= plan.level;
      if (hit) ++rejected[c];
      if (plan.effects[c] == 0.0) continue;
      ++effects;
      if (hit) ++found;
    }
    if (found > 0) ++any;
    if (effects > 0 && found == effects) ++all;
  }
  for (const std::size_t hits : rejected) power.ofCheckpoint.push_back(share(hits, plan.simulations));
  power.anyEffect = share(any, plan.simulations);
  power.allEffects = share(all, plan.simulations);
  power.seed = plan.seed;
  return power;
}

}  // namespace calot::analytics

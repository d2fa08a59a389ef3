// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/power.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

std::string objection(const PowerPlan& plan) {
  if (plan.nx == 0 || plan.ny == 0) return "a group is empty";
  if (plan.population) {
    const auto& people = plan.population->people;
    if (people[0].empty() || people[1].empty()) return "a group has nobody to draw from";
    const std::size_t figures = people[0][0].size();
    if (figures == 0) return "no checkpoint";
    for (const auto& group : people) {
      for (const auto& person : group) {
        if (person.size() != figures) return "people have different numbers of checkpoints";
        for (const std::optional<double>& v : person) {
          if (v && !std::isfinite(*v)) return "a value is not finite";
        }
      }
    }
  } else {
    if (plan.checkpoints.empty()) return "no checkpoint";
    for (const PlannedCheckpoint& c : plan.checkpoints) {
      if (!std::isfinite(c.x.mean) || !std::isfinite(c.y.mean)) return "an effect is not finite";
      for (const double deviation : {c.x.deviation, c.y.deviation}) {
        if (!(deviation > 0.0) || !std::isfinite(deviation)) return "a deviation is not positive";
      }
    }
  }
  if (!(plan.correlation >= 0.0 && plan.correlation < 1.0)) return "the correlation is outside of [0, 1)";
  if (!(plan.step >= 0.0) || !std::isfinite(plan.step)) return "the step is negative";
  if (!(plan.level > 0.0 && plan.level < 1.0)) return "the level is not between 0 and 1";
  if (plan.simulations == 0) return "no simulations";
  return {};
}

/// mannWhitney(), which without ties depends on sizes and U alone: counted once for every U.
class RankTests {
 public:
  Expected<double> p(const std::vector<double>& x, const std::vector<double>& y) {
    const bool ties = x.empty() || y.empty() || tieTerm(pooled(x, y)) > 0.0;
    if (!ties) {
      const double u = std::round(superiority(x, y)->a * static_cast<double>(x.size() * y.size()));
      const auto [known, added] = byU_.emplace(std::tuple(x.size(), y.size(), u), 0.0);
      if (added) known->second = mannWhitney(x, y)->p;
      return known->second;
    }
    const Expected<MannWhitney> test = mannWhitney(x, y);
    return test ? Expected<double>(test->p) : NoResult{test.reason()};
  }

 private:
  std::map<std::tuple<std::size_t, std::size_t, double>, double> byU_;
};

double rounded(double v, double step) { return step > 0.0 ? std::round(v / step) * step : v; }

/// Values of one group, a vector a checkpoint.
std::vector<std::vector<double>> drawGroup(const PowerPlan& plan, std::size_t n, bool first, RandomStream& random) {
  std::vector<std::vector<double>> values(plan.checkpoints.size(), std::vector<double>(n));
  const double common = std::sqrt(plan.correlation), own = std::sqrt(1.0 - plan.correlation);
  for (std::size_t i = 0; i < n; ++i) {
    const double factor = random.normal();
    for (std::size_t c = 0; c < values.size(); ++c) {
      const NormalCurve& curve = first ? plan.checkpoints[c].x : plan.checkpoints[c].y;
      const double v = curve.mean + curve.deviation * (common * factor + own * random.normal());
      values[c][i] = rounded(plan.shape == PowerShape::lognormal ? std::exp(v) : v, plan.step);
    }
  }
  return values;
}

/// The same of people drawn with replacement: a checkpoint has the values of those who have one.
std::vector<std::vector<double>> resampleGroup(const std::vector<std::vector<std::optional<double>>>& people,
                                               std::size_t n, double step, RandomStream& random) {
  std::vector<std::vector<double>> values(people[0].size());
  for (std::size_t i = 0; i < n; ++i) {
    const auto& person = people[static_cast<std::size_t>(random.below(people.size()))];
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (person[c]) values[c].push_back(rounded(*person[c], step));
    }
  }
  return values;
}

std::vector<double> adjusted(const std::vector<double>& p, Adjustment adjustment) {
  if (adjustment == Adjustment::holm) return *holm(p);
  if (adjustment == Adjustment::benjaminiHochberg) return *benjaminiHochberg(p);
  return p;
}

}  // namespace

SimulatedShare wilsonShare(std::size_t hits, std::size_t of) {
  const double n = static_cast<double>(of), p = static_cast<double>(hits) / n, z = normalQuantile(0.975);
  const double centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {p, {std::max(0.0, centre - half), std::min(1.0, centre + half), 0.95, "Wilson"}};
}

std::vector<PlannedCheckpoint> shifts(const std::vector<double>& effects) {
  std::vector<PlannedCheckpoint> checkpoints;
  checkpoints.reserve(effects.size());
  for (const double effect : effects) checkpoints.push_back({{effect, 1.0}, {0.0, 1.0}});
  return checkpoints;
}

Expected<Power> simulatePower(const PowerPlan& plan) {
  if (const std::string reason = objection(plan); !reason.empty()) return NoResult{reason};
  RandomStream random(plan.seed);
  RankTests test;
  const std::size_t checkpoints = plan.population ? plan.population->people[0][0].size() : plan.checkpoints.size();
  std::vector<std::size_t> rejected(checkpoints, 0);
  std::size_t any = 0, all = 0;
  Power power;
  for (std::size_t simulation = 0; simulation < plan.simulations; ++simulation) {
    const auto draw = [&](std::size_t n, bool first) {
      if (!plan.population) return drawGroup(plan, n, first, random);
      return resampleGroup(plan.population->people[first ? 0 : 1], n, plan.step, random);
    };
    const auto x = draw(plan.nx, true);
    const auto y = draw(plan.ny, false);
    std::vector<double> p(checkpoints, 1.0);
    for (std::size_t c = 0; c < checkpoints; ++c) {
      if (const Expected<double> answer = test.p(x[c], y[c])) {
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
      if (!plan.population && !plan.checkpoints[c].effect()) continue;
      ++effects;
      if (hit) ++found;
    }
    if (found > 0) ++any;
    if (effects > 0 && found == effects) ++all;
  }
  for (const std::size_t hits : rejected) power.ofCheckpoint.push_back(wilsonShare(hits, plan.simulations));
  power.anyEffect = wilsonShare(any, plan.simulations);
  power.allEffects = wilsonShare(all, plan.simulations);
  power.seed = plan.seed;
  return power;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/cusum.h"

#include <algorithm>
#include <cmath>

namespace calot::analytics {
namespace {

/// Limits are often met exactly (two failures of ln 3 against ln 9): rounding must not decide, and
/// both forms must agree.
constexpr double reached = 1.0 - 1e-12;

}  // namespace

Expected<CusumDesign> CusumDesign::logLikelihood(const CusumGoal& g) {
  using Result = Expected<CusumDesign>;
  const auto share = [](double v) { return v > 0.0 && v < 1.0; };
  if (!share(g.acceptable) || !share(g.unacceptable)) return Result::none("a failure rate is not between 0 and 1");
  if (!(g.acceptable < g.unacceptable))
    return Result::none("the acceptable failure rate is not below the unacceptable one");
  if (!share(g.alpha) || !share(g.beta) || !(g.alpha + g.beta < 1.0))
    return Result::none("alpha and beta are not positive with a sum below 1");
  return CusumDesign(std::log(g.unacceptable / g.acceptable), std::log((1.0 - g.unacceptable) / (1.0 - g.acceptable)),
                     std::log((1.0 - g.beta) / g.alpha), std::log(g.beta / (1.0 - g.alpha)));
}

Expected<CusumDesign> CusumDesign::scaled(const CusumGoal& goal) {
  const Expected<CusumDesign> d = logLikelihood(goal);
  if (!d) return d;
  const double unit = d->failure_ - d->success_;  // ln of the odds ratio
  return CusumDesign(d->failure_ / unit, d->success_ / unit, d->upper_ / unit, d->lower_ / unit);
}

CusumChart cusum(const CusumDesign& design, const std::vector<bool>& failures, CusumKind kind) {
  CusumChart chart;
  chart.sums.reserve(failures.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < failures.size(); ++i) {
    sum += failures[i] ? design.failureStep() : design.successStep();
    if (kind == CusumKind::monitoring) sum = std::max(0.0, sum);
    chart.sums.push_back(sum);
    if (chart.unacceptable || chart.acceptable) continue;
    if (sum >= design.upperLimit() * reached) chart.unacceptable = i;
    if (kind == CusumKind::sequential && sum <= design.lowerLimit() * reached) chart.acceptable = i;
  }
  return chart;
}

}  // namespace calot::analytics

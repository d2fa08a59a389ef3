// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/contrasting_groups.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytics/statistics/bootstrap.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/roots.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

NormalCurve curveOf(std::span<const double> values) { return {*mean(values), *standardDeviation(values)}; }

Expected<double> cutOf(std::span<const double> experts, std::span<const double> novices, Better better) {
  if (experts.size() < 2 || novices.size() < 2) return Expected<double>::none("a group of one value has no spread");
  const NormalCurve e = curveOf(experts), n = curveOf(novices);
  if (!(e.deviation > 0.0) || !(n.deviation > 0.0)) return Expected<double>::none("a group has no spread");
  if (better == Better::higher ? !(e.mean > n.mean) : !(e.mean < n.mean))
    return Expected<double>::none("the experts' mean is not the better one");
  return crossing(e, n);
}

}  // namespace

Expected<double> crossing(const NormalCurve& first, const NormalCurve& second) {
  using Result = Expected<double>;
  if (!(first.deviation > 0.0) || !(second.deviation > 0.0)) return Result::none("a curve has no width");
  if (!std::isfinite(first.mean) || !std::isfinite(second.mean)) return Result::none("a mean is not finite");
  const NormalCurve& low = first.mean < second.mean ? first : second;
  const NormalCurve& high = first.mean < second.mean ? second : first;
  if (!(low.mean < high.mean)) return Result::none("the means are equal");
  // Logarithm of the ratio of the lower curve to the higher one: falls from one mean to the other.
  const auto ratio = [&](double x) {
    const double a = (x - low.mean) / low.deviation, b = (x - high.mean) / high.deviation;
    return std::log(high.deviation / low.deviation) + 0.5 * (b * b - a * a);
  };
  if (!(ratio(low.mean) > 0.0) || !(ratio(high.mean) < 0.0))
    return Result::none("the curves do not cross between the means");
  return rootBetween(ratio, low.mean, high.mean);
}

Expected<ContrastingGroups> contrastingGroups(std::span<const double> experts, std::span<const double> novices,
                                              Better better, const ContrastingGroupsOptions& options) {
  using Result = Expected<ContrastingGroups>;
  if (experts.empty()) return Result::none("there are no experts");
  if (novices.empty()) return Result::none("there are no novices");
  if (!allFinite(experts) || !allFinite(novices)) return Result::none("a value is not finite");
  std::vector<double> e(experts.begin(), experts.end()), n(novices.begin(), novices.end());
  if (options.logScale) {
    for (auto* group : {&e, &n}) {
      for (double& v : *group) {
        if (!(v > 0.0)) return Result::none("a value is not positive and has no logarithm");
        v = std::log(v);
      }
    }
  }
  const Expected<double> cut = cutOf(e, n, better);
  if (!cut) return Result::none(cut.reason());
  const auto back = [&](double v) { return options.logScale ? std::exp(v) : v; };
  ContrastingGroups result;
  result.cut = back(*cut);
  const auto passes = [&](double v) { return better == Better::higher ? v >= *cut : v <= *cut; };
  const auto judged = [&](const std::vector<double>& group, bool wrong) {
    const NormalCurve curve = curveOf(group);
    const double z = (*cut - curve.mean) / curve.deviation;
    Misjudged m;
    m.observed = static_cast<std::size_t>(
        std::count_if(group.begin(), group.end(), [&](double v) { return passes(v) == wrong; }));
    m.share = static_cast<double>(m.observed) / static_cast<double>(group.size());
    m.theoretical = normalCdf((better == Better::higher) == wrong ? -z : z);
    return m;
  };
  result.falsePositives = judged(n, true);
  result.falseNegatives = judged(e, false);
  BootstrapOptions resampling;
  resampling.resamples = options.resamples;
  resampling.seed = options.seed;
  resampling.level = options.level;
  const auto b = bootstrap(
      e, n, [&](std::span<const double> x, std::span<const double> y) { return cutOf(x, y, better); }, resampling);
  result.seed = options.seed;
  if (b) {
    result.interval = Interval{back(b->interval.lower), back(b->interval.upper), options.level, b->interval.method};
    result.resamplesWithoutCut = b->without;
  } else {
    result.interval = Expected<Interval>::none(b.reason());
  }
  return result;
}

}  // namespace calot::analytics

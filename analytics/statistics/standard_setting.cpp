// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/standard_setting.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {
namespace {

NormalCurve curveOf(std::span<const double> values) { return {*mean(values), *standardDeviation(values)}; }

Expected<double> cutOf(std::span<const double> experts, std::span<const double> novices, Better better) {
  if (experts.size() < 2 || novices.size() < 2) return NoResult{"a group of one value has no spread"};
  const NormalCurve e = curveOf(experts), n = curveOf(novices);
  if (!(e.deviation > 0.0) || !(n.deviation > 0.0)) return NoResult{"a group has no spread"};
  if (better == Better::higher ? !(e.mean > n.mean) : !(e.mean < n.mean))
    return NoResult{"the experts' mean is not the better one"};
  return crossing(e, n);
}

}  // namespace

Expected<double> crossing(const NormalCurve& first, const NormalCurve& second) {
  if (!(first.deviation > 0.0) || !(second.deviation > 0.0)) return NoResult{"a curve has no width"};
  if (!std::isfinite(first.mean) || !std::isfinite(second.mean)) return NoResult{"a mean is not finite"};
  const NormalCurve& low = first.mean < second.mean ? first : second;
  const NormalCurve& high = first.mean < second.mean ? second : first;
  if (!(low.mean < high.mean)) return NoResult{"the means are equal"};
  // Logarithm of the ratio of the lower curve to the higher one: falls from one mean to the other.
  const auto ratio = [&](double x) {
    const double a = (x - low.mean) / low.deviation, b = (x - high.mean) / high.deviation;
    return std::log(high.deviation / low.deviation) + 0.5 * (b * b - a * a);
  };
  if (!(ratio(low.mean) > 0.0) || !(ratio(high.mean) < 0.0))
    return NoResult{"the curves do not cross between the means"};
  return rootBetween(ratio, low.mean, high.mean);
}

Expected<ContrastingGroups> contrastingGroups(std::span<const double> experts, std::span<const double> novices,
                                              Better better, const ContrastingGroupsOptions& options) {
  if (experts.empty()) return NoResult{"there are no experts"};
  if (novices.empty()) return NoResult{"there are no novices"};
  if (!allFinite(experts) || !allFinite(novices)) return NoResult{"a value is not finite"};
  std::vector<double> e(experts.begin(), experts.end()), n(novices.begin(), novices.end());
  if (options.logScale) {
    for (auto* group : {&e, &n}) {
      for (double& v : *group) {
        if (!(v > 0.0)) return NoResult{"a value is not positive and has no logarithm"};
        v = std::log(v);
      }
    }
  }
  const Expected<double> cut = cutOf(e, n, better);
  if (!cut) return NoResult{cut.reason()};
  const auto back = [&](double v) { return options.logScale ? std::exp(v) : v; };
  ContrastingGroups result;
  result.cut = back(*cut);
  const auto b = bootstrap(
      e, n, [&](std::span<const double> x, std::span<const double> y) { return cutOf(x, y, better); }, options);
  result.seed = options.seed;
  if (b) {
    result.interval = Interval{back(b->interval.lower), back(b->interval.upper), options.level, b->interval.method};
  } else {
    result.interval = NoResult{b.reason()};
  }
  return result;
}

Expected<BorderlineRegression> borderlineRegression(std::span<const double> ratings, std::span<const double> scores,
                                                    double mark, Better better, double level) {
  if (ratings.size() != scores.size()) return NoResult{"the two variables have different lengths"};
  if (ratings.size() < 4) return NoResult{"fewer than four rated attempts"};
  const std::vector<double> x(ratings.begin(), ratings.end());
  const std::vector<double> constant(x.size(), 1.0);
  const Expected<double> centre = mean(x);
  if (!centre) return NoResult{centre.reason()};
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  if (*least == *most) return NoResult{"all ratings are equal"};
  if (mark < *least || mark > *most) return NoResult{"all ratings are on one side of the borderline mark"};
  const Expected<LeastSquares> fit = leastSquares({constant, x}, scores);
  if (!fit) return NoResult{fit.reason()};
  BorderlineRegression result;
  result.rated = x.size();
  result.intercept = fit->coefficients[0];
  result.slope = fit->coefficients[1];
  if (!(better == Better::higher ? result.slope > 0.0 : result.slope < 0.0))
    return NoResult{"attempts with better ratings do not have better values"};
  result.cut = result.intercept + result.slope * mark;
  double squares = 0.0, total = 0.0;
  const double middle = *mean(scores);
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - *centre) * (x[i] - *centre);
    total += (scores[i] - middle) * (scores[i] - middle);
    if (x[i] <= mark) ++result.atOrBelowMark;
  }
  result.r = result.slope * std::sqrt(squares / total);
  const double apart = mark - *centre;
  const double error = fit->sigma * std::sqrt(1.0 / static_cast<double>(x.size()) + apart * apart / squares);
  const double half = studentQuantile(0.5 + level / 2.0, fit->df) * error;
  result.interval = {result.cut - half, result.cut + half, level, "Student's t, mean at the mark"};
  return result;
}

Expected<AngoffCut> angoffCut(const RatingTable& judged, double level) {
  if (judged.subjects < 2) return NoResult{"fewer than two judges"};
  if (judged.raters < 1) return NoResult{"no item"};
  if (!std::all_of(judged.values.begin(), judged.values.end(), [](double p) { return p >= 0.0 && p <= 1.0; }))
    return NoResult{"a probability is outside of 0 to 1"};
  std::vector<double> marks;
  for (std::size_t judge = 0; judge < judged.subjects; ++judge) {
    double sum = 0.0;
    for (std::size_t item = 0; item < judged.raters; ++item) sum += judged.at(judge, item);
    marks.push_back(sum);
  }
  AngoffCut result;
  const double n = static_cast<double>(marks.size());
  result.cut = *mean(marks);
  result.error = *standardDeviation(marks) / std::sqrt(n);
  // Sums of rounded probabilities differ in the last bits where the judges agree.
  if (!(result.error > 1e-12 * static_cast<double>(judged.raters))) return NoResult{"all judges have the same mark"};
  const double half = studentQuantile(0.5 + level / 2.0, n - 1.0) * result.error;
  result.interval = {result.cut - half, result.cut + half, level, "Student's t over the judges"};
  return result;
}

}  // namespace calot::analytics

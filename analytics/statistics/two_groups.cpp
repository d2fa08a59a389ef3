// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/two_groups.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rank_sum_distribution.h"

namespace calot::analytics {
namespace {

/// Why these two groups can't be compared, or empty.
std::string objection(std::span<const double> x, std::span<const double> y) {
  if (x.empty() && y.empty()) return "both groups are empty";
  if (x.empty()) return "the first group is empty";
  if (y.empty()) return "the second group is empty";
  for (const auto group : {x, y}) {
    if (!std::all_of(group.begin(), group.end(), [](double v) { return std::isfinite(v); }))
      return "a value is not finite";
  }
  return {};
}

struct Ranked {
  std::vector<double> ranks;  ///< of x, then y
  double sumX = 0.0;
  double u = 0.0;
  double tieTerm = 0.0;  ///< sum of t^3 - t over groups of t equal values
};

Ranked ranked(std::span<const double> x, std::span<const double> y) {
  std::vector<double> pooled(x.begin(), x.end());
  pooled.insert(pooled.end(), y.begin(), y.end());
  Ranked r;
  r.ranks = midRanks(pooled);
  for (std::size_t i = 0; i < x.size(); ++i) r.sumX += r.ranks[i];
  const double nx = static_cast<double>(x.size());
  r.u = r.sumX - nx * (nx + 1.0) / 2.0;
  std::sort(pooled.begin(), pooled.end());
  for (std::size_t first = 0; first < pooled.size();) {
    std::size_t next = first;
    while (next < pooled.size() && pooled[next] == pooled[first]) ++next;
    const double t = static_cast<double>(next - first);
    r.tieTerm += t * t * t - t;
    first = next;
  }
  return r;
}

std::vector<double> allDifferences(std::span<const double> x, std::span<const double> y) {
  std::vector<double> differences;
  differences.reserve(x.size() * y.size());
  for (const double a : x) {
    for (const double b : y) differences.push_back(a - b);
  }
  return differences;
}

}  // namespace

Answer<MannWhitney> mannWhitney(std::span<const double> x, std::span<const double> y, RankTest method) {
  if (const std::string reason = objection(x, y); !reason.empty()) return Answer<MannWhitney>::none(reason);
  const Ranked r = ranked(x, y);
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size()), n = nx + ny;
  if (r.tieTerm == n * n * n - n) return Answer<MannWhitney>::none("all values are equal");
  MannWhitney result;
  result.u = r.u;
  result.ties = r.tieTerm > 0.0;
  result.exact =
      method == RankTest::exact || (method == RankTest::automatic && x.size() + y.size() <= exactRankTestLimit);
  if (result.exact) {
    // The smaller group's sum has the shorter distribution; both sums give the same p, since they add up to a constant.
    const bool byX = x.size() <= y.size();
    const RankSumDistribution distribution(r.ranks, byX ? x.size() : y.size());
    result.p = distribution.asFarAs(byX ? r.sumX : n * (n + 1.0) / 2.0 - r.sumX);
    return result;
  }
  const double variance = nx * ny / 12.0 * (n + 1.0 - r.tieTerm / (n * (n - 1.0)));
  const double distance = std::max(0.0, std::abs(r.u - nx * ny / 2.0) - 0.5);
  const boost::math::normal standard;
  result.p = std::min(1.0, 2.0 * boost::math::cdf(boost::math::complement(standard, distance / std::sqrt(variance))));
  return result;
}

Answer<Superiority> superiority(std::span<const double> x, std::span<const double> y) {
  if (const std::string reason = objection(x, y); !reason.empty()) return Answer<Superiority>::none(reason);
  const double pairs = static_cast<double>(x.size()) * static_cast<double>(y.size());
  const double u = ranked(x, y).u;
  return Superiority{u / pairs, (2.0 * u - pairs) / pairs};
}

Answer<double> hodgesLehmann(std::span<const double> x, std::span<const double> y) {
  if (const std::string reason = objection(x, y); !reason.empty()) return Answer<double>::none(reason);
  // Selection instead of sorting: there are nx ny of them.
  std::vector<double> differences = allDifferences(x, y);
  const auto upper = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), upper, differences.end());
  if (differences.size() % 2 == 1) return *upper;
  const double lower = *std::max_element(differences.begin(), upper);
  return lower + 0.5 * (*upper - lower);
}

Answer<ShiftInterval> hodgesLehmannInterval(std::span<const double> x, std::span<const double> y, double level) {
  using Result = Answer<ShiftInterval>;
  assert(level > 0.0 && level < 1.0);
  if (const std::string reason = objection(x, y); !reason.empty()) return Result::none(reason);
  if (x.size() + y.size() > exactRankTestLimit) return Result::none("too many values for the exact interval");
  const Ranked r = ranked(x, y);
  if (r.tieTerm > 0.0) return Result::none("tied values have no exact interval");
  const bool byX = x.size() <= y.size();
  const std::size_t n = byX ? x.size() : y.size();
  const RankSumDistribution distribution(r.ranks, n);
  const double smallestSum = static_cast<double>(n) * static_cast<double>(n + 1) / 2.0;
  // Lowest u with P(U <= u) >= alpha / 2, as R's qwilcox; U and nx ny - U have the same distribution without ties.
  const std::size_t pairs = x.size() * y.size();
  std::size_t u = 0;
  while (distribution.atMost(smallestSum + static_cast<double>(u)) < (1.0 - level) / 2.0) ++u;
  if (u == 0) return Result::none("the groups are too small for an interval of this level");
  std::vector<double> differences = allDifferences(x, y);
  std::sort(differences.begin(), differences.end());
  return ShiftInterval{differences[u - 1], differences[pairs - u],
                       1.0 - 2.0 * distribution.atMost(smallestSum + static_cast<double>(u) - 1.0)};
}

}  // namespace calot::analytics

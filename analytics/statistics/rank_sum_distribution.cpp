// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/rank_sum_distribution.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace calot::analytics {

std::vector<double> midRanks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b] || (values[a] == values[b] && a < b); });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && values[order[last + 1]] == values[order[first]]) ++last;
    const double rank = 0.5 * static_cast<double>(first + last) + 1.0;
    for (std::size_t i = first; i <= last; ++i) ranks[order[i]] = rank;
    first = last + 1;
  }
  return ranks;
}

RankSumDistribution::RankSumDistribution(std::span<const double> ranks, std::size_t n) {
  assert(n > 0 && n < ranks.size());
  std::vector<std::size_t> half(ranks.size());
  std::transform(ranks.begin(), ranks.end(), half.begin(),
                 [](double r) { return static_cast<std::size_t>(std::lround(2.0 * r)); });
  std::vector<std::size_t> largest = half;
  std::sort(largest.rbegin(), largest.rend());
  const std::size_t top =
      std::accumulate(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(n), std::size_t{0});

  // ways[k][s]: choices of k of the values seen so far whose half ranks sum to s.
  std::vector<std::vector<double>> ways(n + 1, std::vector<double>(top + 1, 0.0));
  ways[0][0] = 1.0;
  std::size_t seen = 0, reach = 0;
  for (const std::size_t r : half) {
    reach = std::min(reach + r, top);
    ++seen;
    for (std::size_t k = std::min(seen, n); k >= 1; --k) {
      for (std::size_t s = reach; s >= r; --s) ways[k][s] += ways[k - 1][s - r];
    }
  }
  count_ = std::move(ways[n]);
  for (const double c : count_) total_ += c;
  expected_ = static_cast<double>(n) * static_cast<double>(ranks.size() + 1) / 2.0;
}

double RankSumDistribution::between(long lower, long upper) const {
  double sum = 0.0;
  const long last = std::min(upper, static_cast<long>(count_.size()) - 1);
  for (long s = std::max(lower, 0L); s <= last; ++s) sum += count_[static_cast<std::size_t>(s)];
  return sum / total_;
}

double RankSumDistribution::atMost(double sum) const { return between(0, std::lround(2.0 * sum)); }

double RankSumDistribution::atLeast(double sum) const {
  return between(std::lround(2.0 * sum), static_cast<long>(count_.size()));
}

double RankSumDistribution::asFarAs(double sum) const {
  // The expected half-rank sum n (N + 1) is an integer, so no rounding decides what is as far out.
  const long centre = std::lround(2.0 * expected_);
  const long distance = std::labs(std::lround(2.0 * sum) - centre);
  if (distance == 0) return 1.0;
  return std::min(1.0, between(0, centre - distance) + between(centre + distance, static_cast<long>(count_.size())));
}

}  // namespace calot::analytics

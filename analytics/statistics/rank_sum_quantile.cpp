// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/rank_sum_quantile.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace calot::analytics {
namespace {

/// w(k; m, n) for k from 0 to `last`. @pre m <= n
std::vector<double> countsOfU(std::size_t m, std::size_t n, std::size_t last) {
  std::vector<std::vector<double>> counts(m + 1, std::vector<double>(last + 1, 0.0));
  for (std::vector<double>& of : counts) of[0] = 1.0;
  for (std::size_t j = 1; j <= n; ++j) {
    for (std::size_t i = 1; i <= m; ++i) {
      const std::size_t end = std::min(last, i * j);
      for (std::size_t k = j; k <= end; ++k) counts[i][k] += counts[i - 1][k - j];
    }
  }
  return std::move(counts[m]);
}

RankSumQuantile counted(std::size_t nx, std::size_t ny, double p) {
  const std::size_t m = std::min(nx, ny), n = std::max(nx, ny);
  double all = 1.0;  // orders: the binomial coefficient of m + n and m
  for (std::size_t i = 1; i <= m; ++i) all *= static_cast<double>(n + i) / static_cast<double>(i);
  const std::vector<double> counts = countsOfU(m, n, m * n / 2);
  RankSumQuantile result;
  double sum = 0.0;
  // U is symmetric about m n / 2: at the middle the sum has reached one half, but for rounding.
  for (result.u = 0; result.u + 1 < counts.size(); ++result.u) {
    const double next = sum + counts[result.u];
    if (next / all >= p) break;
    sum = next;
  }
  result.below = sum / all;
  return result;
}

}  // namespace

RankSumQuantile rankSumQuantile(std::size_t nx, std::size_t ny, double p) {
  assert(nx > 0 && ny > 0 && nx + ny <= 1000 && p > 0.0 && p <= 0.5);
  thread_local std::map<std::tuple<std::size_t, std::size_t, double>, RankSumQuantile> known;
  const std::tuple key(std::min(nx, ny), std::max(nx, ny), p);
  const auto at = known.find(key);
  return at != known.end() ? at->second : known.emplace(key, counted(nx, ny, p)).first->second;
}

}  // namespace calot::analytics

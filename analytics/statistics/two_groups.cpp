// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/two_groups.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/rank_sum_distribution.h"
#include "analytics/statistics/rank_sum_quantile.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {
namespace {

struct Ranked {
  std::vector<double> ranks;  ///< of x, then y
  double sumX = 0.0;
  double u = 0.0;
  double tieTerm = 0.0;
};

Ranked ranked(std::span<const double> x, std::span<const double> y) {
  const std::vector<double> all = pooled(x, y);
  Ranked r;
  r.ranks = midRanks(all);
  r.tieTerm = tieTerm(all);
  for (std::size_t i = 0; i < x.size(); ++i) r.sumX += r.ranks[i];
  const double nx = static_cast<double>(x.size());
  r.u = r.sumX - nx * (nx + 1.0) / 2.0;
  return r;
}

/// All differences x_i - y_j in order, without storing the nx ny of them.
class Differences {
 public:
  Differences(std::span<const double> x, std::span<const double> y) : x_(x.begin(), x.end()), y_(y.begin(), y.end()) {
    std::sort(x_.begin(), x_.end());
    std::sort(y_.begin(), y_.end());
  }

  [[nodiscard]] std::size_t size() const { return x_.size() * y_.size(); }
  /// The k-th smallest, from 0: the least double that at least k + 1 differences do not exceed, found by halving the
  /// doubles between the least and the greatest difference (64 counts at most). @pre k < size()
  [[nodiscard]] double at(std::size_t k) const {
    std::uint64_t low = keyOf(x_.front() - y_.back()), high = keyOf(x_.back() - y_.front());
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (notAbove(valueOf(middle)) > k) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return valueOf(low) + 0.0;  // +0 instead of -0
  }

 private:
  /// Integers in the order of the doubles.
  static std::uint64_t keyOf(double v) {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    return bits >> 63U != 0 ? ~bits : bits | std::uint64_t{1} << 63U;
  }
  static double valueOf(std::uint64_t key) {
    return std::bit_cast<double>(key >> 63U != 0 ? key & ~(std::uint64_t{1} << 63U) : ~key);
  }
  /// Number of differences at most t. Rounding is monotonic, so the bound on y does not decrease with x.
  [[nodiscard]] std::size_t notAbove(double t) const {
    std::size_t count = 0, j = 0;
    for (const double x : x_) {
      while (j < y_.size() && x - y_[j] > t) ++j;
      count += y_.size() - j;
    }
    return count;
  }

  std::vector<double> x_, y_;
};

}  // namespace

Expected<MannWhitney> mannWhitney(std::span<const double> x, std::span<const double> y, RankTest method) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Expected<MannWhitney>::none(reason);
  const Ranked r = ranked(x, y);
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size()), n = nx + ny;
  if (r.tieTerm == n * n * n - n) return Expected<MannWhitney>::none("all values are equal");
  MannWhitney result;
  result.u = r.u;
  result.ties = r.tieTerm > 0.0;
  result.exact =
      method == RankTest::exact || (method == RankTest::automatic && x.size() + y.size() <= exactRankTestLimit);
  // Rank sums of the assignments in which one group has the smallest or the largest values.
  std::vector<double> ordered = r.ranks;
  std::sort(ordered.begin(), ordered.end());
  const auto lowestSum = [&](std::size_t k) {
    return std::accumulate(ordered.begin(), ordered.begin() + static_cast<std::ptrdiff_t>(k), 0.0);
  };
  const double whole = n * (n + 1.0) / 2.0;
  if (result.exact) {
    // The smaller group's sum has the shorter distribution; both sums give the same p, since they add up to a constant.
    const bool byX = x.size() <= y.size();
    const std::size_t fewer = byX ? x.size() : y.size(), more = x.size() + y.size() - fewer;
    const RankSumDistribution distribution(r.ranks, fewer);
    result.p = distribution.asFarAs(byX ? r.sumX : whole - r.sumX);
    result.smallestP = std::min(distribution.asFarAs(lowestSum(fewer)), distribution.asFarAs(whole - lowestSum(more)));
    return result;
  }
  const double variance = nx * ny / 12.0 * (n + 1.0 - r.tieTerm / (n * (n - 1.0)));
  const auto asymptotic = [&](double u) {
    return normalTwoSided(std::max(0.0, std::abs(u - nx * ny / 2.0) - 0.5) / std::sqrt(variance));
  };
  const double least = nx * (nx + 1.0) / 2.0;
  result.p = asymptotic(r.u);
  result.smallestP = std::min(asymptotic(lowestSum(x.size()) - least), asymptotic(whole - lowestSum(y.size()) - least));
  return result;
}

double smallestRankTestP(std::size_t nx, std::size_t ny) {
  assert(nx > 0 && ny > 0);
  std::vector<double> x(nx), y(ny);
  std::iota(x.begin(), x.end(), 0.0);
  std::iota(y.begin(), y.end(), static_cast<double>(nx));
  const Expected<MannWhitney> separated = mannWhitney(x, y);
  return separated ? separated->p : 1.0;
}

std::size_t leastGroups(double p) {
  assert(p > 0.0);
  std::size_t n = 1;
  while (smallestRankTestP(n, n) > p) ++n;
  return n;
}

Expected<Superiority> superiority(std::span<const double> x, std::span<const double> y) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Expected<Superiority>::none(reason);
  const double pairs = static_cast<double>(x.size()) * static_cast<double>(y.size());
  const double u = ranked(x, y).u;
  return Superiority{u / pairs, (2.0 * u - pairs) / pairs};
}

Expected<double> hodgesLehmann(std::span<const double> x, std::span<const double> y) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Expected<double>::none(reason);
  const Differences differences(x, y);
  const double upper = differences.at(differences.size() / 2);
  if (differences.size() % 2 == 1) return upper;
  const double lower = differences.at(differences.size() / 2 - 1);
  return lower + 0.5 * (upper - lower);
}

const char* nameOf(ShiftMethod method) {
  switch (method) {
    case ShiftMethod::exact:
      return "exact";
    case ShiftMethod::conservative:
      return "conservative";
    case ShiftMethod::asymptotic:
      return "asymptotic";
  }
  return "";
}

Expected<ShiftInterval> hodgesLehmannInterval(std::span<const double> x, std::span<const double> y, double level) {
  using Result = Expected<ShiftInterval>;
  assert(level > 0.0 && level < 1.0);
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Result::none(reason);
  const double n = static_cast<double>(x.size() + y.size()), ties = tieTerm(pooled(x, y));
  if (ties == n * n * n - n) return Result::none("all values are equal");
  // Rank u of the difference that ends the interval, from below and from above.
  std::size_t u = 0;
  ShiftInterval result;
  if (x.size() + y.size() <= exactShiftLimit) {
    // The distribution without ties, whether there are any or not: that makes the closed interval conservative.
    const RankSumQuantile quantile = rankSumQuantile(x.size(), y.size(), (1.0 - level) / 2.0);
    u = quantile.u;
    if (u == 0) return Result::none("the groups are too small for an interval of this level");
    result.attained = 1.0 - 2.0 * quantile.below;
    result.method = ties > 0.0 ? ShiftMethod::conservative : ShiftMethod::exact;
  } else {
    const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size());
    const double rank = nx * ny / 2.0 - normalQuantile(0.5 + level / 2.0) * std::sqrt(nx * ny * (n + 1.0) / 12.0);
    if (rank < 1.0) return Result::none("the groups are too small for an interval of this level");
    u = static_cast<std::size_t>(rank);
    result.attained = level;
    result.method = ShiftMethod::asymptotic;
  }
  const Differences differences(x, y);
  result.lower = differences.at(u - 1);
  result.upper = differences.at(differences.size() - u);
  return result;
}

}  // namespace calot::analytics

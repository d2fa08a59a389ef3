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
  if (result.exact) {
    // The smaller group's sum has the shorter distribution; both sums give the same p, since they add up to a constant.
    const bool byX = x.size() <= y.size();
    const RankSumDistribution distribution(r.ranks, byX ? x.size() : y.size());
    result.p = distribution.asFarAs(byX ? r.sumX : n * (n + 1.0) / 2.0 - r.sumX);
    return result;
  }
  const double variance = nx * ny / 12.0 * (n + 1.0 - r.tieTerm / (n * (n - 1.0)));
  const double distance = std::max(0.0, std::abs(r.u - nx * ny / 2.0) - 0.5);
  result.p = normalTwoSided(distance / std::sqrt(variance));
  return result;
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
  if (x.size() + y.size() <= exactRankTestLimit) {
    // The distribution without ties, whether there are any or not: that makes the closed interval conservative.
    std::vector<double> ranks(x.size() + y.size());
    std::iota(ranks.begin(), ranks.end(), 1.0);
    const std::size_t fewer = std::min(x.size(), y.size());
    const RankSumDistribution distribution(ranks, fewer);
    const double minSum = static_cast<double>(fewer) * static_cast<double>(fewer + 1) / 2.0;
    // Lowest u with P(U <= u) >= alpha / 2, as R's qwilcox; U and nx ny - U have the same distribution.
    while (distribution.atMost(minSum + static_cast<double>(u)) < (1.0 - level) / 2.0) ++u;
    if (u == 0) return Result::none("the groups are too small for an interval of this level");
    result.attained = 1.0 - 2.0 * distribution.atMost(minSum + static_cast<double>(u) - 1.0);
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

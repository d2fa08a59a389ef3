// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/two_groups.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

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

/// Permutation distribution of the sum of the mid-ranks of one group of `n`, when every choice of n of the N pooled
/// values is equally likely: exact with ties. Counted by dynamic programming over the pooled values (one value after
/// the other is in the group or not): O(N n S) with S the largest sum in half ranks. Counts are exact integers while
/// C(N, n) < 2^53 and carry a relative error below N * 2^-53 beyond, since all terms are positive.
class RankSumDistribution {
 public:
  /// @param ranks of the pooled values (multiples of 1/2); @pre 0 < n < ranks.size().
  RankSumDistribution(std::span<const double> ranks, std::size_t n)
      : centre_(static_cast<long>(n * (ranks.size() + 1))) {
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
  }

  /// P(|S - E S| >= |sum - E S|): both tails as far out as the observed sum. The expected half-rank sum n (N + 1) is an
  /// integer, so no rounding decides what is as far out.
  [[nodiscard]] double asFarAs(double sum) const {
    const long distance = std::labs(std::lround(2.0 * sum) - centre_);
    if (distance == 0) return 1.0;
    return std::min(1.0,
                    between(0, centre_ - distance) + between(centre_ + distance, static_cast<long>(count_.size())));
  }

  /// P(S >= sum), or P(S <= sum).
  [[nodiscard]] double tail(double sum, bool upper) const {
    const long at = std::lround(2.0 * sum);
    return std::min(1.0, upper ? between(at, static_cast<long>(count_.size())) : between(0, at));
  }

 private:
  /// Probability of half-rank sums in [lower, upper].
  [[nodiscard]] double between(long lower, long upper) const {
    double sum = 0.0;
    const long last = std::min(upper, static_cast<long>(count_.size()) - 1);
    for (long s = std::max(lower, 0L); s <= last; ++s) sum += count_[static_cast<std::size_t>(s)];
    return sum / total_;
  }

  long centre_;
  std::vector<double> count_;  ///< by half-rank sum
  double total_ = 0.0;
};

}  // namespace

Expected<MannWhitney> mannWhitney(std::span<const double> x, std::span<const double> y, RankTest method) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  const Ranked r = ranked(x, y);
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size()), n = nx + ny;
  if (r.tieTerm == n * n * n - n) return NoResult{"all values are equal"};
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
    result.greater = distribution.tail(byX ? r.sumX : whole - r.sumX, byX);
    result.smallestP = std::min(distribution.asFarAs(lowestSum(fewer)), distribution.asFarAs(whole - lowestSum(more)));
    return result;
  }
  const double variance = nx * ny / 12.0 * (n + 1.0 - r.tieTerm / (n * (n - 1.0)));
  const auto asymptotic = [&](double u) {
    return normalTwoSided(std::max(0.0, std::abs(u - nx * ny / 2.0) - 0.5) / std::sqrt(variance));
  };
  const double least = nx * (nx + 1.0) / 2.0;
  result.p = asymptotic(r.u);
  result.greater = 0.5 * std::erfc((r.u - nx * ny / 2.0 - 0.5) / std::sqrt(2.0 * variance));
  result.smallestP = std::min(asymptotic(lowestSum(x.size()) - least), asymptotic(whole - lowestSum(y.size()) - least));
  return result;
}

Expected<double> marginTest(std::span<const double> larger, std::span<const double> other, double margin,
                            bool bothSides) {
  const auto below = [margin](std::span<const double> x, std::span<const double> y) -> Expected<double> {
    std::vector<double> shifted(y.begin(), y.end());
    for (double& v : shifted) v += margin;
    const Expected<MannWhitney> test = mannWhitney(shifted, x);
    if (!test) return NoResult{test.reason()};
    return test->greater;
  };
  const Expected<double> one = below(larger, other), two = bothSides ? below(other, larger) : one;
  if (!one || !two) return one ? two : one;
  return std::max(*one, *two);
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
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  const double pairs = static_cast<double>(x.size()) * static_cast<double>(y.size());
  const double u = ranked(x, y).u;
  return Superiority{u / pairs, (2.0 * u - pairs) / pairs};
}

Expected<double> hodgesLehmann(std::span<const double> x, std::span<const double> y) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  const Differences differences(x, y);
  const double upper = differences.at(differences.size() / 2);
  if (differences.size() % 2 == 1) return upper;
  const double lower = differences.at(differences.size() / 2 - 1);
  return lower + 0.5 * (upper - lower);
}

const char* nameOf(ShiftMethod method) {
  static constexpr const char* names[]{"exact", "conservative", "asymptotic"};
  return names[static_cast<std::size_t>(method)];
}

Expected<ShiftInterval> hodgesLehmannInterval(std::span<const double> x, std::span<const double> y, double level) {
  assert(level > 0.0 && level < 1.0);
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  const double n = static_cast<double>(x.size() + y.size()), ties = tieTerm(pooled(x, y));
  if (ties == n * n * n - n) return NoResult{"all values are equal"};
  // Rank u of the difference that ends the interval, from below and from above.
  std::size_t u = 0;
  ShiftInterval result;
  if (x.size() + y.size() <= exactShiftLimit) {
    // The distribution without ties, whether there are any or not: that makes the closed interval conservative.
    const RankSumQuantile quantile = rankSumQuantile(x.size(), y.size(), (1.0 - level) / 2.0);
    u = quantile.u;
    if (u == 0) return NoResult{"the groups are too small for an interval of this level"};
    result.attained = 1.0 - 2.0 * quantile.below;
    result.method = ties > 0.0 ? ShiftMethod::conservative : ShiftMethod::exact;
  } else {
    const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size());
    const double rank = nx * ny / 2.0 - normalQuantile(0.5 + level / 2.0) * std::sqrt(nx * ny * (n + 1.0) / 12.0);
    if (rank < 1.0) return NoResult{"the groups are too small for an interval of this level"};
    u = static_cast<std::size_t>(rank);
    result.attained = level;
    result.method = ShiftMethod::asymptotic;
  }
  const Differences differences(x, y);
  result.lower = differences.at(u - 1);
  result.upper = differences.at(differences.size() - u);
  return result;
}

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

Expected<StratifiedRankSum> stratifiedRankSum(std::span<const Stratum> strata) {
  StratifiedRankSum result;
  double sum = 0.0, variance = 0.0, wins = 0.0, weights = 0.0;
  for (const Stratum& s : strata) {
    if (!allFinite(s.x) || !allFinite(s.y)) return NoResult{"a value is not finite"};
    const double nx = static_cast<double>(s.x.size()), ny = static_cast<double>(s.y.size()), n = nx + ny;
    const double ties = tieTerm(pooled(s.x, s.y));
    if (s.x.empty() || s.y.empty() || ties == n * n * n - n) {
      ++result.left;
      continue;
    }
    ++result.strata;
    const double area = superiority(s.x, s.y)->a, weight = 1.0 / (n + 1.0);
    sum += weight * nx * ny * (area - 0.5);
    variance += weight * weight * nx * ny / 12.0 * (n + 1.0 - ties / (n * (n - 1.0)));
    wins += weight * nx * ny * area;
    weights += weight * nx * ny;
  }
  if (result.strata == 0) return NoResult{"no stratum holds both groups and values that differ"};
  result.z = sum / std::sqrt(variance);
  result.p = normalTwoSided(result.z);
  result.a = wins / weights;
  return result;
}

Expected<HedgesG> hedgesG(std::span<const double> x, std::span<const double> y, double level) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  if (x.size() < 2 || y.size() < 2) return NoResult{"a group of one value has no spread"};
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size()), m = nx + ny - 2.0;
  const double sx = *standardDeviation(x), sy = *standardDeviation(y);
  const double spread = std::sqrt(((nx - 1.0) * sx * sx + (ny - 1.0) * sy * sy) / m);
  if (!(spread > 0.0)) return NoResult{"no spread within the groups"};
  HedgesG result;
  result.d = (*mean(x) - *mean(y)) / spread;
  // Logarithms: Gamma itself overflows beyond 340 values.
  result.j = std::exp(std::lgamma(m / 2.0) - std::lgamma((m - 1.0) / 2.0)) / std::sqrt(m / 2.0);
  result.g = result.j * result.d;
  const double scale = std::sqrt(nx * ny / (nx + ny)), t = result.d * scale, tail = (1.0 - level) / 2.0;
  const double lower = noncentralStudentParameter(t, m, 1.0 - tail), upper = noncentralStudentParameter(t, m, tail);
  if (std::isfinite(lower) && std::isfinite(upper)) {
    result.interval = Interval{result.j * lower / scale, result.j * upper / scale, level, "J times non-central t"};
  } else {
    result.interval = NoResult{"the effect is too large for the non-central t distribution"};
  }
  return result;
}

namespace {

/// [lower, upper] of Newcombe's method 5.
Interval scoreInterval(double a, double nx, double ny, double z, double level) {
  const double extra = (nx + ny) / 2.0 - 1.0;
  const auto excess = [&](double t) {
    const double spread = t * (1.0 - t) * (1.0 + extra * ((1.0 - t) / (2.0 - t) + t / (1.0 + t))) / (nx * ny);
    return (a - t) * (a - t) - z * z * spread;
  };
  // Positive outside of the interval, negative inside; zero at A itself where A is 0 or 1, hence the step inwards.
  constexpr double step = 1e-9;
  Interval result{0.0, 1.0, level, "score"};
  if (a > 0.0) result.lower = rootBetween(excess, 0.0, std::min(a, 1.0 - step));
  if (a < 1.0) result.upper = rootBetween(excess, std::max(a, step), 1.0);
  return result;
}

}  // namespace

Expected<SuperiorityEstimate> estimateSuperiority(std::span<const double> x, std::span<const double> y,
                                                  Hypothesis hypothesis, double level) {
  assert(level > 0.0 && level < 1.0);
  if (hypothesis == Hypothesis::firstSmaller) std::swap(x, y);
  const Expected<Superiority> value = superiority(x, y);
  if (!value) return NoResult{hypothesis == Hypothesis::firstSmaller ? twoGroupObjection(y, x) : value.reason()};
  const double n = static_cast<double>(x.size() + y.size());
  if (tieTerm(pooled(x, y)) == n * n * n - n) return NoResult{"all values are equal"};
  SuperiorityEstimate result;
  result.value = *value;
  const double a = value->a, z = normalQuantile(0.5 + level / 2.0);
  result.a = scoreInterval(a, static_cast<double>(x.size()), static_cast<double>(y.size()), z, level);
  result.delta = {2.0 * result.a.lower - 1.0, 2.0 * result.a.upper - 1.0, level, result.a.method};
  return result;
}

}  // namespace calot::analytics

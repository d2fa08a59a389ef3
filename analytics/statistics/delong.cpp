// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/delong.h"

#include <cmath>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

constexpr std::size_t maxForAllExchanges = 16;
constexpr std::uint64_t randomExchanges = 9999;

double variance(std::span<const double> values) {
  const double s = *standardDeviation(values);
  return s * s;
}

std::vector<double> differences(std::span<const double> a, std::span<const double> b) {
  std::vector<double> d(a.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = a[i] - b[i];
  return d;
}

/// The areas of both figures from the ranks of all people, those of x first.
class RankExchange {
 public:
  explicit RankExchange(const PairedFigures& f)
      : nx_(f.firstX.size()),
        first_(midRanks(pooled(f.firstX, f.firstY))),
        second_(midRanks(pooled(f.secondX, f.secondY))) {}

  [[nodiscard]] std::size_t people() const { return first_.size(); }
  [[nodiscard]] bool alike() const { return first_ == second_; }

  /// A1 - A2 when the people for whom `swap` says so have their two ranks exchanged.
  template <class Swap>
  double difference(const Swap& swap) {
    std::vector<double> a = first_, b = second_;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (swap(i)) std::swap(a[i], b[i]);
    }
    return area(a) - area(b);
  }

 private:
  [[nodiscard]] double area(const std::vector<double>& r) const {
    const std::vector<double> ranks = midRanks(r);
    double sum = 0.0;
    for (std::size_t i = 0; i < nx_; ++i) sum += ranks[i];
    const double nx = static_cast<double>(nx_), ny = static_cast<double>(r.size() - nx_);
    return (sum - nx * (nx + 1.0) / 2.0) / (nx * ny);
  }
  std::size_t nx_;
  std::vector<double> first_, second_;
};

void fallBack(PairedAreas& result, RankExchange& exchange, std::uint64_t seed) {
  const double observed = std::abs(exchange.difference([](std::size_t) { return false; })) - 1e-12;
  const std::size_t n = exchange.people();
  std::uint64_t hits = 0;
  result.method = "permutation of ranks, ";
  if (n <= maxForAllExchanges) {
    const std::uint64_t all = std::uint64_t{1} << n;
    for (std::uint64_t set = 0; set < all; ++set) {
      if (std::abs(exchange.difference([&](std::size_t i) { return (set >> i & 1U) != 0; })) >= observed) ++hits;
    }
    result.p = static_cast<double>(hits) / static_cast<double>(all);
    result.method += "all exchanges";
  } else {
    RandomStream random(seed);
    for (std::uint64_t i = 0; i < randomExchanges; ++i) {
      if (std::abs(exchange.difference([&](std::size_t) { return random.below(2) == 1; })) >= observed) ++hits;
    }
    result.p = static_cast<double>(hits + 1) / static_cast<double>(randomExchanges + 1);
    result.method += "9999 random exchanges";
    result.seed = seed;
  }
  result.method += ", since DeLong's variance vanishes (an area of 0 or 1, or figures that place everybody alike)";
}

}  // namespace

Expected<DeLong> deLong(std::span<const double> x, std::span<const double> y) {
  using Result = Expected<DeLong>;
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return Result::none(reason);
  if (x.size() < 2 || y.size() < 2) return Result::none("a group of one value has no variance");
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size());
  DeLong d;
  // How many of the other group a value exceeds, ties half, is its rank among all less that within its own group (Sun
  // and Xu 2014, IEEE Signal Process. Lett. 21:1389): halves, so exact, without looking at every pair.
  const std::vector<double> among = midRanks(pooled(x, y)), withinX = midRanks(x), withinY = midRanks(y);
  double wins = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    d.ofX.push_back(among[i] - withinX[i]);
    wins += d.ofX.back();
  }
  for (std::size_t j = 0; j < y.size(); ++j) d.ofY.push_back(nx - (among[x.size() + j] - withinY[j]));
  for (double& v : d.ofX) v /= ny;
  for (double& w : d.ofY) w /= nx;
  d.a = wins / (nx * ny);
  d.variance = variance(d.ofX) / nx + variance(d.ofY) / ny;
  return d;
}

Expected<PairedAreas> compareAreas(const PairedFigures& f, double level, std::uint64_t seed) {
  using Result = Expected<PairedAreas>;
  if (f.firstX.size() != f.secondX.size() || f.firstY.size() != f.secondY.size())
    return Result::none("the two figures are not of the same people");
  const Expected<DeLong> first = deLong(f.firstX, f.firstY), second = deLong(f.secondX, f.secondY);
  if (!first) return Result::none(first.reason());
  if (!second) return Result::none(second.reason());
  RankExchange exchange(f);
  if (exchange.alike()) return Result::none("the two figures rank everybody alike");
  PairedAreas result;
  result.first = first->a;
  result.second = second->a;
  result.difference = first->a - second->a;
  const double ofDifference = variance(differences(first->ofX, second->ofX)) / static_cast<double>(f.firstX.size()) +
                              variance(differences(first->ofY, second->ofY)) / static_cast<double>(f.firstY.size());
  if (!(first->variance > 0.0) || !(second->variance > 0.0) || !(ofDifference > 0.0)) {
    fallBack(result, exchange, seed);
    return result;
  }
  const double deviation = std::sqrt(ofDifference);
  result.z = result.difference / deviation;
  result.p = normalTwoSided(*result.z);
  const double half = normalQuantile(0.5 + level / 2.0) * deviation;
  result.interval = Interval{result.difference - half, result.difference + half, level, "DeLong"};
  result.method = "DeLong";
  return result;
}

}  // namespace calot::analytics

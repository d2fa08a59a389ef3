// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/resampling.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

struct MeanRanks {
  std::vector<double> of, size;  ///< by group
  double n = 0.0, tieTerm = 0.0;
};

Expected<MeanRanks> meanRanks(std::span<const std::vector<double>> groups) {
  if (groups.size() < 2) return NoResult{"fewer than two groups"};
  std::vector<double> all;
  for (const std::vector<double>& group : groups) {
    if (group.empty()) return NoResult{"a group is empty"};
    if (!allFinite(group)) return NoResult{"a value is not finite"};
    all.insert(all.end(), group.begin(), group.end());
  }
  MeanRanks m;
  m.n = static_cast<double>(all.size());
  m.tieTerm = tieTerm(all);
  if (m.tieTerm == m.n * m.n * m.n - m.n) return NoResult{"all values are equal"};
  const std::vector<double> ranks = midRanks(all);
  std::size_t next = 0;
  for (const std::vector<double>& group : groups) {
    double sum = 0.0;
    for (std::size_t i = 0; i < group.size(); ++i) sum += ranks[next++];
    m.size.push_back(static_cast<double>(group.size()));
    m.of.push_back(sum / m.size.back());
  }
  return m;
}

}  // namespace

Expected<KruskalWallis> kruskalWallis(std::span<const std::vector<double>> groups) {
  const Expected<MeanRanks> m = meanRanks(groups);
  if (!m) return NoResult{m.reason()};
  const double n = m->n;
  KruskalWallis result;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double distance = m->of[g] - (n + 1.0) / 2.0;
    result.h += m->size[g] * distance * distance;
  }
  result.h *= 12.0 / (n * (n + 1.0)) / (1.0 - m->tieTerm / (n * n * n - n));
  result.df = static_cast<double>(groups.size() - 1);
  result.p = chiSquaredUpper(result.h, result.df);
  result.epsilonSquared = result.h / (n - 1.0);
  return result;
}

Expected<std::vector<DunnPair>> dunn(std::span<const std::vector<double>> groups) {
  const Expected<MeanRanks> m = meanRanks(groups);
  if (!m) return NoResult{m.reason()};
  const double n = m->n, variance = n * (n + 1.0) / 12.0 - m->tieTerm / (12.0 * (n - 1.0));
  std::vector<DunnPair> pairs;
  std::vector<double> p;
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = a + 1; b < groups.size(); ++b) {
      DunnPair pair{a, b};
      pair.z = (m->of[a] - m->of[b]) / std::sqrt(variance * (1.0 / m->size[a] + 1.0 / m->size[b]));
      pair.p = normalTwoSided(pair.z);
      p.push_back(pair.p);
      pairs.push_back(pair);
    }
  }
  const Expected<std::vector<double>> adjusted = holm(p);
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].adjusted = (*adjusted)[i];
  return pairs;
}

namespace {

/// Pooled values in order: the end of each set of equal values.
using TieEnds = std::vector<std::size_t>;

/// Twice the placements are whole numbers: no rounding decides which assignments are as far out.
BrunnerMunzel studentised(const std::vector<char>& inX, const TieEnds& ends, double nx, double ny) {
  double ofX = 0.0, ofY = 0.0, squaresX = 0.0, squaresY = 0.0, belowX = 0.0, belowY = 0.0;
  std::size_t i = 0;
  for (const std::size_t end : ends) {
    double hereX = 0.0;
    const double here = static_cast<double>(end - i);
    for (; i < end; ++i) hereX += inX[i];
    const double hereY = here - hereX, x = 2.0 * belowY + hereY, y = 2.0 * belowX + hereX;
    ofX += hereX * x;
    ofY += hereY * y;
    squaresX += hereX * x * x;
    squaresY += hereY * y * y;
    belowX += hereX;
    belowY += hereY;
  }
  const double x = (nx * squaresX - ofX * ofX) / (nx - 1.0), y = (ny * squaresY - ofY * ofY) / (ny - 1.0);
  const double distance = ofX - nx * ny;
  BrunnerMunzel result;
  if (distance != 0.0) result.statistic = distance / std::sqrt(x + y);
  if (x + y > 0.0) result.df = (x + y) * (x + y) / (x * x / (nx - 1.0) + y * y / (ny - 1.0));
  return result;
}

/// Assignments of the values, as many as are as far out as the statistic.
double shareOfAssignments(std::vector<char> inX, const TieEnds& ends, double nx, double ny, double statistic,
                          bool all) {
  constexpr double rounding = 1e-12;
  const double edge = std::abs(statistic) * (1.0 - rounding);
  const auto isFar = [&] { return std::abs(studentised(inX, ends, nx, ny).statistic) >= edge ? 1.0 : 0.0; };
  double far = 0.0, count = 0.0;
  if (all) {
    std::sort(inX.begin(), inX.end());
    do {
      far += isFar();
      ++count;
    } while (std::next_permutation(inX.begin(), inX.end()));
    return far / count;
  }
  RandomStream random(1);
  for (std::size_t draw = 0; draw < brunnerMunzelAssignments; ++draw) {
    for (std::size_t i = inX.size(); i > 1; --i) std::swap(inX[i - 1], inX[random.below(i)]);
    far += isFar();
  }
  return (far + 1.0) / (static_cast<double>(brunnerMunzelAssignments) + 1.0);
}

}  // namespace

Expected<BrunnerMunzel> brunnerMunzel(std::span<const double> x, std::span<const double> y, RankTest method) {
  if (const std::string reason = twoGroupObjection(x, y); !reason.empty()) return NoResult{reason};
  if (x.size() < 2 || y.size() < 2) return NoResult{"a group of one value has no spread"};
  std::vector<std::pair<double, char>> values;
  for (const double v : x) values.emplace_back(v, 1);
  for (const double v : y) values.emplace_back(v, 0);
  std::sort(values.begin(), values.end());
  if (values.front().first == values.back().first) return NoResult{"all values are equal"};
  std::vector<char> inX;
  TieEnds ends;
  for (std::size_t i = 0; i < values.size(); ++i) {
    inX.push_back(values[i].second);
    if (i + 1 == values.size() || values[i].first != values[i + 1].first) ends.push_back(i + 1);
  }
  const double nx = static_cast<double>(x.size()), ny = static_cast<double>(y.size());
  BrunnerMunzel result = studentised(inX, ends, nx, ny);
  result.exact = method == RankTest::exact || (method == RankTest::automatic && values.size() <= exactRankTestLimit);
  if (result.exact) {
    double assignments = 1.0;  // the binomial coefficient of nx + ny and nx
    for (double i = 1.0; i <= nx; ++i) assignments *= (ny + i) / i;
    const bool all = method == RankTest::exact || assignments <= static_cast<double>(brunnerMunzelAssignments) + 0.5;
    result.p = shareOfAssignments(std::move(inX), ends, nx, ny, result.statistic, all);
    if (method == RankTest::exact || result.df == 0.0) return result;
  } else if (result.df == 0.0) {
    return NoResult{"the groups do not overlap"};
  } else {
    result.p = 0.0;
  }
  result.p = std::max(result.p, studentTwoSided(result.statistic, result.df));
  return result;
}

namespace {

/// Twice the mid-ranks about their mean: sums of products are whole numbers, and rounding decides nothing.
std::vector<long> centredRanks(std::span<const double> values) {
  const std::vector<double> ranks = midRanks(values);
  std::vector<long> centred(ranks.size());
  for (std::size_t i = 0; i < ranks.size(); ++i)
    centred[i] = std::lround(2.0 * ranks[i]) - static_cast<long>(ranks.size()) - 1;
  return centred;
}

long product(const std::vector<long>& a, const std::vector<long>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0L);
}

double shareOfOrders(const std::vector<long>& a, std::vector<long> b) {
  const long observed = std::labs(product(a, b));
  std::vector<std::size_t> order(b.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<long> moved(b.size());
  long hits = 0, all = 0;
  do {
    for (std::size_t i = 0; i < b.size(); ++i) moved[i] = b[order[i]];
    ++all;
    if (std::labs(product(a, moved)) >= observed) ++hits;
  } while (std::next_permutation(order.begin(), order.end()));
  return static_cast<double>(hits) / static_cast<double>(all);
}

/// ln of the product of the factorials of the sizes of the ties.
double logTieFactorials(std::vector<long> values) {
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  for (auto first = values.begin(); first != values.end();) {
    const auto next = std::upper_bound(first, values.end(), *first);
    sum += std::lgamma(static_cast<double>(next - first) + 1.0);
    first = next;
  }
  return sum;
}

}  // namespace

Expected<Spearman> spearman(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) return NoResult{"the two variables have different lengths"};
  if (x.size() < 3) return NoResult{"fewer than three pairs"};
  if (!allFinite(x) || !allFinite(y)) return NoResult{"a value is not finite"};
  const std::vector<long> a = centredRanks(x), b = centredRanks(y);
  const long aa = product(a, a), bb = product(b, b), ab = product(a, b);
  if (aa == 0 || bb == 0) return NoResult{"a variable has all values equal"};
  Spearman result;
  result.ties = tieTerm(x) > 0.0 || tieTerm(y) > 0.0;
  const double n = static_cast<double>(x.size());
  result.rho = static_cast<double>(ab) / (std::sqrt(static_cast<double>(aa)) * std::sqrt(static_cast<double>(bb)));
  result.rho = std::clamp(result.rho, -1.0, 1.0);
  if (x.size() <= exactSpearmanLimit) {
    result.exact = true;
    result.p = shareOfOrders(a, b);
  } else if (aa == bb && std::labs(ab) == aa) {
    result.p = 2.0 * std::exp(logTieFactorials(a) - std::lgamma(n + 1.0));
  } else {
    result.p = studentTwoSided(result.rho * std::sqrt((n - 2.0) / ((1.0 - result.rho) * (1.0 + result.rho))), n - 2.0);
  }
  return result;
}

Expected<Interval> spearmanInterval(double rho, std::size_t n, double level) {
  if (n < 4) return NoResult{"fewer than four pairs"};
  constexpr double rounding = 1e-12;
  if (!(std::abs(rho) < 1.0 - rounding)) return NoResult{"the ranks agree perfectly"};
  const double half =
      normalQuantile(0.5 + level / 2.0) * std::sqrt((1.0 + 0.5 * rho * rho) / (static_cast<double>(n) - 3.0));
  return Interval{std::tanh(std::atanh(rho) - half), std::tanh(std::atanh(rho) + half), level, "Bonett and Wright"};
}

namespace {

std::string objection(std::span<const double> p) {
  if (p.empty()) return "no p values";
  if (!std::all_of(p.begin(), p.end(), [](double v) { return v >= 0.0 && v <= 1.0; }))
    return "a p value is outside of [0, 1]";
  return {};
}

std::vector<std::size_t> ascending(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return p[a] < p[b] || (p[a] == p[b] && a < b); });
  return order;
}

}  // namespace

Expected<std::vector<double>> holm(std::span<const double> p) {
  if (const std::string reason = objection(p); !reason.empty()) return NoResult{reason};
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

Expected<std::vector<double>> benjaminiHochberg(std::span<const double> p) {
  if (const std::string reason = objection(p); !reason.empty()) return NoResult{reason};
  const std::vector<std::size_t> order = ascending(p);
  std::vector<double> adjusted(p.size());
  double smallest = 1.0;
  for (std::size_t i = p.size(); i-- > 0;) {
    smallest = std::min(smallest, static_cast<double>(p.size()) * p[order[i]] / static_cast<double>(i + 1));
    adjusted[order[i]] = smallest;
  }
  return adjusted;
}

}  // namespace calot::analytics

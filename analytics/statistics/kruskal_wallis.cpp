// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/kruskal_wallis.h"

#include <cmath>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/multiplicity.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

struct MeanRanks {
  std::vector<double> of, size;  ///< by group
  double n = 0.0, tieTerm = 0.0;
};

Expected<MeanRanks> meanRanks(std::span<const std::vector<double>> groups) {
  using Result = Expected<MeanRanks>;
  if (groups.size() < 2) return Result::none("fewer than two groups");
  std::vector<double> all;
  for (const std::vector<double>& group : groups) {
    if (group.empty()) return Result::none("a group is empty");
    if (!allFinite(group)) return Result::none("a value is not finite");
    all.insert(all.end(), group.begin(), group.end());
  }
  MeanRanks m;
  m.n = static_cast<double>(all.size());
  m.tieTerm = tieTerm(all);
  if (m.tieTerm == m.n * m.n * m.n - m.n) return Result::none("all values are equal");
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
  if (!m) return Expected<KruskalWallis>::none(m.reason());
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
  using Result = Expected<std::vector<DunnPair>>;
  const Expected<MeanRanks> m = meanRanks(groups);
  if (!m) return Result::none(m.reason());
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

}  // namespace calot::analytics

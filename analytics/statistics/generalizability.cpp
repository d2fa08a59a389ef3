// SPDX-License-Identifier: GPL-3.0-or-later
// Generalizability theory of one crossed facet, people nested in groups: components, decisions, shares.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/reliability.h"

namespace calot::analytics {

DecisionStudy Generalizability::at(std::size_t k) const {
  assert(k > 0);
  const double n = static_cast<double>(k), relative = residual / n, absolute = (facet + residual) / n;
  const auto share = [&](double error) { return person > 0.0 ? person / (person + error) : 0.0; };
  return {share(relative), share(absolute), std::sqrt(relative), std::sqrt(absolute)};
}

namespace {

/// Mean squares of people nested in groups, and what makes them components.
struct NestedMeanSquares {
  double groups = 1.0, people = 0.0, levels = 0.0;
  double person = 0.0;    ///< pooled within groups
  double level = 0.0;     ///< of the groups, one counting as much as another
  double common = 0.0;    ///< of the levels' means over all groups, each group counting as much as another
  double residual = 0.0;  ///< pooled within groups
  double between = 0.0;   ///< variance of the groups' means
  double inverse = 0.0;   ///< mean of 1 / people of a group
  double persons = 0.0;   ///< degrees of freedom of `person`
};

/// Reason why the tables have no components, or empty. One of several may be all equal.
std::string objectionTo(std::span<const RatingTable> groups) {
  RatingTable all{0, groups.front().raters, {}};
  for (const RatingTable& table : groups) {
    if (table.subjects < 2) return objection(table);
    all.subjects += table.subjects;
    all.values.insert(all.values.end(), table.values.begin(), table.values.end());
  }
  return objection(all);
}

/// @pre objectionTo() is empty, or is of tables of these sizes
NestedMeanSquares nestedMeanSquares(std::span<const RatingTable> tables) {
  NestedMeanSquares s;
  s.groups = static_cast<double>(tables.size());
  s.levels = static_cast<double>(tables.front().raters);
  std::vector<double> effect(tables.front().raters, 0.0), middle;  // of a level over the groups; of a group
  for (const RatingTable& table : tables) {
    const MeanSquares m = meanSquares(table);
    const double n = static_cast<double>(table.subjects);
    s.people += n;
    s.persons += n - 1.0;
    s.person += (n - 1.0) * m.subjects;
    s.residual += (n - 1.0) * m.residual;
    s.level += m.raters / (n * s.groups);
    s.inverse += 1.0 / (n * s.groups);
    middle.push_back(*mean(table.values));
    for (std::size_t i = 0; i < table.subjects; ++i) {
      for (std::size_t j = 0; j < table.raters; ++j) effect[j] += (table.at(i, j) - middle.back()) / (n * s.groups);
    }
  }
  s.person /= s.persons;
  s.residual /= s.persons;
  s.level /= s.inverse;
  for (const double e : effect) s.common += e * e / (s.levels - 1.0) * s.groups / s.inverse;
  if (s.level == 0.0) s.common = 0.0;  // not the rounding of the effects
  const double grand = *mean(middle);
  for (const double m : middle) s.between += (m - grand) * (m - grand) / std::max(1.0, s.groups - 1.0);
  return s;
}

Generalizability componentsOf(const NestedMeanSquares& s) {
  Generalizability result;
  result.groups = static_cast<std::size_t>(s.groups);
  result.people = static_cast<std::size_t>(s.people);
  result.levels = static_cast<std::size_t>(s.levels);
  const auto component = [&result](double estimate) {
    if (estimate < 0.0) result.truncated = true;
    return std::max(0.0, estimate);
  };
  const double facet = (s.level - s.residual) * s.inverse;
  const double common = result.groups > 1 ? (s.common - s.residual) * s.inverse / s.groups : facet;
  result.person = component((s.person - s.residual) / s.levels);
  result.facet = component(facet);
  result.residual = s.residual;
  result.common = component(common);
  if (result.groups == 1) return result;
  result.interaction = component(facet - common);
  result.group = component((s.groups - 1.0) / s.groups * (s.between - s.person * s.inverse / s.levels) -
                           (facet - common) / s.levels);
  return result;
}

}  // namespace

Expected<Generalizability> generalizability(std::span<const RatingTable> groups) {
  if (const std::string reason = objectionTo(groups); !reason.empty()) return NoResult{reason};
  const NestedMeanSquares s = nestedMeanSquares(groups);
  Generalizability result = componentsOf(s);
  const double f = s.person / s.residual, df2 = s.persons * (s.levels - 1.0), p = 0.975;
  result.gInterval = s.residual > 0.0 && s.person > 0.0
                         ? Expected<Interval>(Interval{1.0 - fisherQuantile(p, s.persons, df2) / f,
                                                       1.0 - 1.0 / (f * fisherQuantile(p, df2, s.persons)), 0.95, "F"})
                         : NoResult{"people or levels do not differ"};
  return result;
}

Expected<LevelShares> levelShares(std::span<const RatingTable> groups, const BootstrapOptions& options) {
  if (const std::string reason = objectionTo(groups); !reason.empty()) return NoResult{reason};
  const auto sharesOf = [](const NestedMeanSquares& s) -> Expected<std::vector<double>> {
    const Generalizability g = componentsOf(s);
    const double total = g.person + g.facet + g.residual;
    if (!(total > 0.0)) return NoResult{"nothing varies within groups"};
    return std::vector<double>{(g.facet + g.residual) / total, g.common / total, g.interaction / total,
                               g.residual / total};
  };
  const Expected<std::vector<double>> value = sharesOf(nestedMeanSquares(groups));
  if (!value) return NoResult{value.reason()};
  ValueGroups places;  // of people in their tables
  for (const RatingTable& table : groups) {
    places.emplace_back();
    for (std::size_t i = 0; i < table.subjects; ++i) places.back().push_back(static_cast<double>(i));
  }
  std::vector<RatingTable> drawn(groups.begin(), groups.end());
  const auto intervals = bootstrapSeveral(
      places,
      [&](const ValueGroups& chosen) {
        for (std::size_t g = 0; g < groups.size(); ++g) {
          const std::size_t k = groups[g].raters;
          for (std::size_t i = 0; i < groups[g].subjects; ++i) {
            const auto from =
                groups[g].values.begin() + static_cast<std::ptrdiff_t>(chosen[g][i]) * static_cast<std::ptrdiff_t>(k);
            std::copy_n(from, k, drawn[g].values.begin() + static_cast<std::ptrdiff_t>(i * k));
          }
        }
        NestedMeanSquares s = nestedMeanSquares(drawn);
        s.level -= s.residual;
        s.common -= s.residual;
        return sharesOf(s);
      },
      options);
  LevelShares result;
  VarianceShare* const shares[] = {&result.level, &result.common, &result.interaction, &result.residual};
  for (std::size_t i = 0; i < std::size(shares); ++i) {
    shares[i]->value = (*value)[i];
    shares[i]->interval = !intervals         ? Expected<Interval>(NoResult{intervals.reason()})
                          : !(*intervals)[i] ? Expected<Interval>(NoResult{(*intervals)[i].reason()})
                                             : Expected<Interval>((*intervals)[i]->interval);
  }
  return result;
}

}  // namespace calot::analytics

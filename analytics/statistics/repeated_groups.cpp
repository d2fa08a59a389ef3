// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/repeated_groups.h"

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/intercept_model.h"

namespace calot::analytics {
namespace {

std::string repeatedObjection(std::span<const OccasionValue> values, const std::set<double>& occasions,
                              OccasionKind kind) {
  std::map<std::size_t, bool> group;
  std::map<double, std::set<bool>> at;
  bool anyX = false, anyY = false;
  for (const OccasionValue& v : values) {
    if (!std::isfinite(v.value) || !std::isfinite(v.occasion)) return "a value is not finite";
    if (group.try_emplace(v.participant, v.inX).first->second != v.inX) return "a participant is in both groups";
    (v.inX ? anyX : anyY) = true;
    at[v.occasion].insert(v.inX);
  }
  if (!anyX) return "the first group is empty";
  if (!anyY) return "the second group is empty";
  if (occasions.size() < 2) return "there is one occasion only";
  if (group.size() < 4) return "fewer than four participants";
  for (const auto& item : at) {
    if (kind == OccasionKind::named && item.second.size() < 2) return "at an occasion there is one group only";
  }
  return {};
}

ModelTerm termOf(const InterceptModel& model, std::size_t column, double df, double level) {
  ModelTerm term;
  term.estimate = model.coefficients[column];
  term.error = model.errors[column];
  term.df = df;
  term.t = term.estimate / term.error;
  term.p = studentTwoSided(term.t, df);
  const double half = studentQuantile(0.5 + level / 2.0, df) * term.error;
  term.interval = {term.estimate - half, term.estimate + half, level, "Student's t, REML"};
  return term;
}

}  // namespace

Expected<RepeatedGroups> repeatedGroups(std::span<const OccasionValue> values, OccasionKind kind,
                                        std::span<const std::size_t> sites, double level) {
  using Result = Expected<RepeatedGroups>;
  std::set<double> occasions;
  for (const OccasionValue& v : values) occasions.insert(v.occasion);
  if (const std::string reason = repeatedObjection(values, occasions, kind); !reason.empty())
    return Result::none(reason);
  if (!sites.empty() && sites.size() != values.size()) return Result::none("the columns have different lengths");
  const std::set<std::size_t> siteSet(sites.begin(), sites.end());
  const std::size_t steps = kind == OccasionKind::number ? 1 : occasions.size() - 1;
  const std::size_t strata = siteSet.empty() ? 0 : siteSet.size() - 1;
  std::vector<std::vector<double>> columns(2 + 2 * steps + strata);
  std::vector<std::size_t> whose;
  std::vector<double> y;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const OccasionValue& v = values[i];
    const double x = v.inX ? 1.0 : 0.0;
    whose.push_back(v.participant);
    y.push_back(v.value);
    columns[0].push_back(1.0);
    columns[1].push_back(x);
    auto later = std::next(occasions.begin());
    for (std::size_t s = 0; s < steps; ++s, ++later) {
      const double step = kind == OccasionKind::number ? v.occasion - *occasions.begin()
                          : v.occasion == *later       ? 1.0
                                                       : 0.0;
      columns[2 + s].push_back(step);
      columns[2 + steps + s].push_back(x * step);
    }
    if (strata == 0) continue;
    std::size_t column = 2 + 2 * steps;
    for (auto site = std::next(siteSet.begin()); site != siteSet.end(); ++site)
      columns[column++].push_back(sites[i] == *site ? 1.0 : 0.0);
  }
  const Expected<InterceptModel> model = fitInterceptModel(columns, whose, y);
  if (!model) return Result::none(model.reason());
  const double people = static_cast<double>(model->participants);
  const double outer = people - 2.0 - static_cast<double>(strata);
  const double inner = static_cast<double>(model->attempts) - people - 2.0 * static_cast<double>(steps);
  if (outer < 1.0 || inner < 1.0) return Result::none("too few attempts for the model");
  RepeatedGroups result;
  result.group = termOf(*model, 1, outer, level);
  for (std::size_t s = 0; s < steps; ++s) {
    result.occasion.push_back(termOf(*model, 2 + s, inner, level));
    result.interaction.push_back(termOf(*model, 2 + steps + s, inner, level));
  }
  result.betweenVariance = model->betweenVariance;
  result.withinVariance = model->withinVariance;
  result.restrictedLogLikelihood = model->restrictedLogLikelihood;
  result.participants = model->participants;
  result.attempts = model->attempts;
  result.occasions = occasions.size();
  return result;
}

}  // namespace calot::analytics

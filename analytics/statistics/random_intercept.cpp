// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/random_intercept.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/intercept_model.h"

namespace calot::analytics {
namespace {

struct Standing {
  bool inX = false;
  std::size_t site = 0;
};

std::string gather(std::span<const ModelAttempt> attempts, std::map<std::size_t, Standing>& participants) {
  bool anyX = false, anyY = false;
  for (const ModelAttempt& a : attempts) {
    if (!std::isfinite(a.value)) return "a value is not finite";
    (a.inX ? anyX : anyY) = true;
    const Standing& p = participants.try_emplace(a.participant, Standing{a.inX, a.site}).first->second;
    if (p.inX != a.inX) return "a participant is in both groups";
    if (p.site != a.site) return "a participant is at two sites";
  }
  if (!anyX) return "the first group is empty";
  if (!anyY) return "the second group is empty";
  return {};
}

}  // namespace

Expected<RandomIntercept> randomIntercept(std::span<const ModelAttempt> attempts, double level) {
  using Result = Expected<RandomIntercept>;
  std::map<std::size_t, Standing> participants;
  if (const std::string reason = gather(attempts, participants); !reason.empty()) return Result::none(reason);
  std::set<std::size_t> sites;
  for (const auto& item : participants) sites.insert(item.second.site);
  std::vector<std::vector<double>> columns(1 + sites.size());
  std::vector<std::size_t> whose;
  std::vector<double> y;
  for (const ModelAttempt& a : attempts) {
    whose.push_back(a.participant);
    y.push_back(a.value);
    columns[0].push_back(a.inX ? 1.0 : 0.0);
    std::size_t column = 1;
    for (const std::size_t site : sites) columns[column++].push_back(a.site == site ? 1.0 : 0.0);
  }
  const bool few = participants.size() < sites.size() + 2;
  const Expected<InterceptModel> model = fitInterceptModel(columns, whose, y);
  if (!model && model.reason().find(": take ") != std::string::npos) return Result::none(model.reason());
  if (few) return Result::none("too few participants for the model");
  if (!model) {
    return Result::none(model.reason() == "the columns depend on each other" ? "group and site can't be told apart"
                                                                             : model.reason());
  }
  RandomIntercept result;
  result.difference = model->coefficients[0];
  result.error = model->errors[0];
  result.df = static_cast<double>(participants.size() - sites.size()) - 1.0;
  result.t = result.difference / result.error;
  result.p = studentTwoSided(result.t, result.df);
  const double half = studentQuantile(0.5 + level / 2.0, result.df) * result.error;
  result.interval = {result.difference - half, result.difference + half, level, "Student's t, REML"};
  result.withinVariance = model->withinVariance;
  result.betweenVariance = model->betweenVariance;
  result.restrictedLogLikelihood = model->restrictedLogLikelihood;
  return result;
}

}  // namespace calot::analytics

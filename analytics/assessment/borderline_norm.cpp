// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/borderline_norm.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>

#include "analytics/statistics/borderline_regression.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

std::map<std::string, double> meanRatings(const std::vector<Rating>& ratings, const std::string& form) {
  std::map<std::string, std::pair<double, double>> sums;  // of raters' means, and their number
  for (const Rating& r : ratings) {
    if (r.form != form || r.attempt.empty() || r.answers.empty()) continue;
    double sum = 0.0;
    for (const auto& item : r.answers) sum += item.second;
    auto& [total, raters] = sums[r.attempt];
    total += sum / static_cast<double>(r.answers.size());
    raters += 1.0;
  }
  std::map<std::string, double> means;
  for (const auto& [attempt, sum] : sums) means[attempt] = sum.first / sum.second;
  return means;
}

std::vector<AttemptRow> groupedByRating(std::vector<AttemptRow> attempts, const std::map<std::string, double>& ratings,
                                        const BorderlineMark& borderline, const std::string& name) {
  if (ratings.empty())
    throw Error(ErrorKind::refused, Where{name}, fmt::format("no attempt was rated with form {}", borderline.form),
                {Remedy::rateAttempts});
  std::set<std::string> seen;
  for (AttemptRow& a : attempts) {  // by start
    const auto at = ratings.find(a.uuid);
    a.group.clear();
    if (at == ratings.end()) continue;
    if (!a.participant.empty() && !seen.insert(a.participant).second) continue;
    a.group = at->second >= borderline.mark ? atMarkGroup : belowMarkGroup;
  }
  return attempts;
}

Expected<RegressionCut> borderlineCut(const std::vector<double>& ratings, const std::vector<double>& values,
                                      double mark, Direction direction, bool logScale) {
  std::vector<double> scores;
  scores.reserve(values.size());
  for (const double v : values) scores.push_back(logScale ? std::log(v) : v);
  const Expected<BorderlineRegression> line =
      borderlineRegression(ratings, scores, mark, direction == Direction::lower ? Better::lower : Better::higher);
  if (!line) return Expected<RegressionCut>::none(line.reason());
  const auto back = [logScale](double v) { return logScale ? std::exp(v) : v; };
  return RegressionCut{back(line->cut), back(line->interval.lower), back(line->interval.upper)};
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/mixed_models.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {
namespace {

/// The rows of the model, ordered by participant.
struct ClusteredRows {
  std::vector<std::vector<double>> columns;
  std::vector<double> y;
  std::vector<std::size_t> sizes;  ///< of the participants
};

std::string collectRows(const std::vector<std::vector<double>>& columns, std::span<const std::size_t> participants,
                        std::span<const double> y, ClusteredRows& rows) {
  if (participants.size() != y.size()) return "the columns have different lengths";
  if (!allFinite(y)) return "a value is not finite";
  std::map<std::size_t, std::vector<std::size_t>> of;
  for (std::size_t i = 0; i < y.size(); ++i) of[participants[i]].push_back(i);
  bool repeated = false, scatter = false;
  rows.columns.resize(columns.size());
  for (const auto& item : of) {
    rows.sizes.push_back(item.second.size());
    repeated = repeated || item.second.size() > 1;
    for (const std::size_t i : item.second) {
      scatter = scatter || y[i] != y[item.second.front()];
      rows.y.push_back(y[i]);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns[c].size() != y.size()) return "the columns have different lengths";
        rows.columns[c].push_back(columns[c][i]);
      }
    }
  }
  if (!repeated) return "no participant has two attempts: take the first or the mean";
  if (!scatter) return "all attempts of each participant are equal: take the mean";
  return {};
}

/// A column less `shrink` times each participant's mean.
std::vector<double> shrunk(const std::vector<double>& column, const std::vector<std::size_t>& sizes, double ratio) {
  std::vector<double> result;
  result.reserve(column.size());
  std::size_t first = 0;
  for (const std::size_t count : sizes) {
    const double n = static_cast<double>(count), shrink = 1.0 - 1.0 / std::sqrt(1.0 + n * ratio);
    double centre = 0.0;
    for (std::size_t i = first; i < first + count; ++i) centre += column[i] / n;
    for (std::size_t i = first; i < first + count; ++i) result.push_back(column[i] - shrink * centre);
    first += count;
  }
  return result;
}

/// The model after the transformation for one ratio of the variances.
struct RatioProfile {
  Expected<LeastSquares> fit = NoResult{""};
  double deviance = HUGE_VAL;  ///< -2 restricted log-likelihood without constants
  double slope = 0.0;          ///< of the deviance over the ratio
};

RatioProfile profileAt(const ClusteredRows& rows, double ratio) {
  std::vector<std::vector<double>> columns;
  for (const std::vector<double>& column : rows.columns) columns.push_back(shrunk(column, rows.sizes, ratio));
  RatioProfile result;
  result.fit = leastSquares(columns, shrunk(rows.y, rows.sizes, ratio));
  if (!result.fit) return result;
  const LeastSquares& fit = *result.fit;
  // With V_i = I + ratio 11', d V^-1 = -V^-1 11' V^-1, and the sum of a participant's row of V^-1 is 1 /
  // (1 + n ratio).
  const std::size_t p = columns.size();
  double logs = 0.0, ofSquares = 0.0, ofLogs = 0.0;
  std::size_t first = 0;
  for (const std::size_t count : rows.sizes) {
    const double n = static_cast<double>(count), inflation = 1.0 + n * ratio;
    logs += std::log1p(n * ratio);
    double residuals = 0.0;
    std::vector<double> sums(p, 0.0);
    for (std::size_t i = first; i < first + count; ++i) {
      residuals += fit.residuals[i];
      for (std::size_t a = 0; a < p; ++a) sums[a] += columns[a][i];
    }
    ofSquares -= residuals * residuals / inflation;
    ofLogs += n / inflation;
    for (std::size_t a = 0; a < p; ++a) {
      for (std::size_t b = 0; b < p; ++b) ofLogs -= sums[a] * sums[b] / inflation * fit.unscaled[a * p + b];
    }
    first += count;
  }
  result.deviance = fit.df * std::log(fit.residualSumOfSquares / fit.df) + logs + fit.logDeterminant;
  result.slope = fit.df * ofSquares / fit.residualSumOfSquares + ofLogs;
  return result;
}

}  // namespace

Expected<InterceptModel> fitInterceptModel(const std::vector<std::vector<double>>& columns,
                                           std::span<const std::size_t> participants, std::span<const double> y) {
  ClusteredRows rows;
  if (const std::string reason = collectRows(columns, participants, y, rows); !reason.empty()) return NoResult{reason};
  // Ratio 0 and a grid over its logarithm, then the root of the slope around the best.
  const RatioProfile unrelated = profileAt(rows, 0.0);
  if (!unrelated.fit) return NoResult{unrelated.fit.reason()};
  constexpr double low = -12.0, high = 24.0, step = 0.5;
  double bestLog = low, least = unrelated.deviance;
  for (double logRatio = low; logRatio <= high; logRatio += step) {
    const double deviance = profileAt(rows, std::exp(logRatio)).deviance;
    if (deviance < least) {
      least = deviance;
      bestLog = logRatio;
    }
  }
  if (bestLog + step > high) return NoResult{"attempts of each participant scatter too little: take the mean"};
  double ratio = 0.0;  // or so small that the result is the same
  if (bestLog > low) {
    // Root of the slope rather than minimum of the deviance, which is known to half of the digits only.
    const auto slope = [&](double logRatio) { return profileAt(rows, std::exp(logRatio)).slope; };
    if (!(slope(bestLog - step) < 0.0) || !(slope(bestLog + step) > 0.0))
      return NoResult{"the likelihood has no clear maximum"};
    ratio = std::exp(rootBetween(slope, bestLog - step, bestLog + step));
  }
  const RatioProfile best = profileAt(rows, ratio);
  if (!best.fit) return NoResult{best.fit.reason()};
  InterceptModel result;
  const LeastSquares& fit = *best.fit;
  result.coefficients = fit.coefficients;
  result.errors = fit.standardErrors();
  result.withinVariance = fit.sigma * fit.sigma;
  result.betweenVariance = ratio * result.withinVariance;
  constexpr double logTwoPi = 1.8378770664093454836;
  result.restrictedLogLikelihood = -0.5 * (fit.df * (1.0 + logTwoPi) + best.deviance);
  result.participants = rows.sizes.size();
  result.attempts = rows.y.size();
  return result;
}

namespace {

ModelTerm termOf(const InterceptModel& model, std::size_t column, double df, double level) {
  return modelTerm(model.coefficients[column], model.errors[column], df, level, "Student's t, REML");
}

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
  std::map<std::size_t, Standing> participants;
  if (const std::string reason = gather(attempts, participants); !reason.empty()) return NoResult{reason};
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
  if (!model && model.reason().find(": take ") != std::string::npos) return NoResult{model.reason()};
  if (few) return NoResult{"too few participants for the model"};
  if (!model) {
    return NoResult{model.reason() == "the columns depend on each other" ? "group and site cannot be distinguished"
                                                                         : model.reason()};
  }
  const double df = static_cast<double>(participants.size() - sites.size()) - 1.0;
  return RandomIntercept{termOf(*model, 0, df, level), *model};
}

namespace {

using Means = std::map<double, std::vector<double>>;  ///< values by occasion

std::optional<double> slopeOf(const Means& at) {
  std::vector<double> times, values;
  for (const auto& [occasion, list] : at) {
    times.insert(times.end(), list.size(), occasion);
    values.insert(values.end(), list.begin(), list.end());
  }
  if (at.size() < 2) return std::nullopt;
  const double centre = *mean(times), level = *mean(values);
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    products += (times[i] - centre) * (values[i] - level);
    squares += (times[i] - centre) * (times[i] - centre);
  }
  return products / squares;
}

}  // namespace

std::vector<std::vector<ParticipantValue>> personalChanges(std::span<const OccasionValue> values, OccasionKind kind) {
  std::set<double> occasions;
  std::map<std::size_t, Means> people;
  for (const OccasionValue& v : values) {
    if (!std::isfinite(v.value) || !std::isfinite(v.occasion)) return {};
    occasions.insert(v.occasion);
    people[v.participant][v.occasion].push_back(v.value);
  }
  std::vector<std::vector<ParticipantValue>> changes;
  for (auto later = occasions.begin(); later != occasions.end(); ++later) {
    if (later == occasions.begin()) continue;
    std::vector<ParticipantValue>& list = changes.emplace_back();
    for (const auto& [person, at] : people) {
      std::optional<double> change;
      std::size_t attempts = 0;
      for (const auto& item : at) attempts += item.second.size();
      if (kind == OccasionKind::number) {
        change = slopeOf(at);
      } else if (at.count(*occasions.begin()) > 0 && at.count(*later) > 0) {
        change = *mean(at.at(*later)) - *mean(at.at(*occasions.begin()));
      }
      if (change && std::isfinite(*change)) list.push_back({person, *change, attempts});
    }
    if (kind == OccasionKind::number) break;
  }
  return changes;
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/random_intercept.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analytics/statistics/distributions.h"
#include "analytics/statistics/least_squares.h"
#include "analytics/statistics/roots.h"

namespace calot::analytics {
namespace {

struct Participant {
  bool inX = false;
  std::size_t site = 0;
  std::vector<double> values;
};

using Participants = std::map<std::size_t, Participant>;

std::string gather(std::span<const ModelAttempt> attempts, Participants& participants) {
  bool anyX = false, anyY = false, repeated = false, scatter = false;
  for (const ModelAttempt& a : attempts) {
    if (!std::isfinite(a.value)) return "a value is not finite";
    (a.inX ? anyX : anyY) = true;
    Participant& p = participants.try_emplace(a.participant, Participant{a.inX, a.site, {}}).first->second;
    if (p.inX != a.inX) return "a participant is in both groups";
    if (p.site != a.site) return "a participant is at two sites";
    repeated = repeated || !p.values.empty();
    scatter = scatter || (!p.values.empty() && p.values.front() != a.value);
    p.values.push_back(a.value);
  }
  if (!anyX) return "the first group is empty";
  if (!anyY) return "the second group is empty";
  if (!repeated) return "no participant has two attempts: take the first or the mean";
  if (!scatter) return "all attempts of each participant are equal: take the mean";
  return {};
}

/// The model after the transformation for one ratio of the variances.
struct Profile {
  Expected<LeastSquares> fit = Expected<LeastSquares>::none("");
  double deviance = HUGE_VAL;  ///< -2 restricted log-likelihood without constants
  double slope = 0.0;          ///< of the deviance over the ratio
};

Profile profile(const Participants& participants, const std::vector<std::size_t>& sites, double ratio) {
  std::vector<std::vector<double>> columns(1 + sites.size());
  std::vector<double> y;
  double logs = 0.0;
  for (const auto& item : participants) {
    const Participant& p = item.second;
    const double n = static_cast<double>(p.values.size()), shrink = 1.0 - 1.0 / std::sqrt(1.0 + n * ratio);
    logs += std::log1p(n * ratio);
    double centre = 0.0;
    for (const double v : p.values) centre += v / n;
    for (const double v : p.values) {
      y.push_back(v - shrink * centre);
      columns[0].push_back(p.inX ? 1.0 - shrink : 0.0);
      for (std::size_t s = 0; s < sites.size(); ++s) columns[1 + s].push_back(p.site == sites[s] ? 1.0 - shrink : 0.0);
    }
  }
  Profile result;
  result.fit = leastSquares(columns, y);
  if (result.fit) {
    const double df = result.fit->df;
    result.deviance = df * std::log(result.fit->residualSumOfSquares / df) + logs + result.fit->logDeterminant;
    // With V_i = I + ratio 11', d V^-1 = -V^-1 11' V^-1, and the sum of a participant's row of V^-1 is 1 /
    // (1 + n ratio).
    const std::size_t p = columns.size();
    double ofSquares = 0.0, ofLogs = 0.0;
    std::size_t first = 0;
    for (const auto& item : participants) {
      const std::size_t count = item.second.values.size();
      const double n = static_cast<double>(count), inflation = 1.0 + n * ratio;
      double residuals = 0.0;
      for (std::size_t i = first; i < first + count; ++i) residuals += result.fit->residuals[i];
      ofSquares -= residuals * residuals / inflation;
      ofLogs += n / inflation;
      for (std::size_t a = 0; a < p; ++a) {
        for (std::size_t b = 0; b < p; ++b)
          ofLogs -= n * n / inflation * columns[a][first] * columns[b][first] * result.fit->unscaled[a * p + b];
      }
      first += count;
    }
    result.slope = df * ofSquares / result.fit->residualSumOfSquares + ofLogs;
  }
  return result;
}

}  // namespace

Expected<RandomIntercept> randomIntercept(std::span<const ModelAttempt> attempts, double level) {
  using Result = Expected<RandomIntercept>;
  Participants participants;
  if (const std::string reason = gather(attempts, participants); !reason.empty()) return Result::none(reason);
  std::set<std::size_t> siteSet;
  for (const auto& item : participants) siteSet.insert(item.second.site);
  const std::vector<std::size_t> sites(siteSet.begin(), siteSet.end());
  if (participants.size() < sites.size() + 2) return Result::none("too few participants for the model");
  // Ratio 0 and a grid over its logarithm, then the root of the slope around the best.
  const Profile unrelated = profile(participants, sites, 0.0);
  if (!unrelated.fit) {
    return Result::none(unrelated.fit.reason() == "the columns depend on each other"
                            ? "group and site can't be told apart"
                            : unrelated.fit.reason());
  }
  constexpr double low = -12.0, high = 24.0, step = 0.5;
  double bestLog = low, least = unrelated.deviance;
  for (double logRatio = low; logRatio <= high; logRatio += step) {
    const double deviance = profile(participants, sites, std::exp(logRatio)).deviance;
    if (deviance < least) {
      least = deviance;
      bestLog = logRatio;
    }
  }
  if (bestLog + step > high) return Result::none("attempts of each participant scatter too little: take the mean");
  double ratio = 0.0;  // or so small that the result is the same
  if (bestLog > low) {
    // Root of the slope rather than minimum of the deviance, which is known to half of the digits only.
    const auto slope = [&](double logRatio) { return profile(participants, sites, std::exp(logRatio)).slope; };
    if (!(slope(bestLog - step) < 0.0) || !(slope(bestLog + step) > 0.0))
      return Result::none("the likelihood has no clear maximum");
    ratio = std::exp(rootBetween(slope, bestLog - step, bestLog + step));
  }
  const Profile best = profile(participants, sites, ratio);
  RandomIntercept result;
  const LeastSquares& fit = *best.fit;
  result.difference = fit.coefficients[0];
  result.error = fit.standardErrors()[0];
  result.df = static_cast<double>(participants.size() - sites.size()) - 1.0;
  result.t = result.difference / result.error;
  result.p = studentTwoSided(result.t, result.df);
  const double half = studentQuantile(0.5 + level / 2.0, result.df) * result.error;
  result.interval = {result.difference - half, result.difference + half, level, "Student's t, REML"};
  result.withinVariance = fit.sigma * fit.sigma;
  result.betweenVariance = ratio * result.withinVariance;
  constexpr double logTwoPi = 1.8378770664093454836;
  result.restrictedLogLikelihood = -0.5 * (fit.df * (1.0 + logTwoPi) + best.deviance);
  return result;
}

}  // namespace calot::analytics

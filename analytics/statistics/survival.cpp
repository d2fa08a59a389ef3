// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/statistics/survival.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <vector>

#include "analytics/statistics/distributions.h"

namespace calot::analytics {
namespace {

std::string objection(std::span<const CensoredTime> x, std::span<const CensoredTime> y) {
  if (x.empty()) return "the first group is empty";
  if (y.empty()) return "the second group is empty";
  for (const auto group : {x, y}) {
    if (!std::all_of(group.begin(), group.end(),
                     [](const CensoredTime& t) { return t.time > 0.0 && std::isfinite(t.time); }))
      return "a time is not positive";
  }
  return {};
}

std::vector<double> ranked(std::span<const CensoredTime> group, double behind) {
  std::vector<double> values;
  values.reserve(group.size());
  for (const CensoredTime& t : group) values.push_back(t.finished ? t.time : behind);
  return values;
}

}  // namespace

Expected<LogRank> logRank(std::span<const CensoredTime> x, std::span<const CensoredTime> y) {
  if (const std::string reason = objection(x, y); !reason.empty()) return NoResult{reason};
  struct Entry {
    double time;
    bool finished, inX;
  };
  std::vector<Entry> entries;
  for (const CensoredTime& t : x) entries.push_back({t.time, t.finished, true});
  for (const CensoredTime& t : y) entries.push_back({t.time, t.finished, false});
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
  double followed = static_cast<double>(entries.size()), followedX = static_cast<double>(x.size());
  LogRank result;
  bool anyFinished = false;
  for (std::size_t first = 0; first < entries.size();) {
    double left = 0.0, leftX = 0.0, finished = 0.0;
    std::size_t next = first;
    for (; next < entries.size() && entries[next].time == entries[first].time; ++next) {
      const Entry& e = entries[next];
      left += 1.0;
      leftX += e.inX ? 1.0 : 0.0;
      if (!e.finished) continue;
      finished += 1.0;
      result.observed += e.inX ? 1.0 : 0.0;
    }
    if (finished > 0.0) {
      anyFinished = true;
      const double share = followedX / followed;
      result.expected += finished * share;
      if (followed > 1.0)
        result.variance += finished * share * (1.0 - share) * (followed - finished) / (followed - 1.0);
    }
    followed -= left;
    followedX -= leftX;
    first = next;
  }
  if (!anyFinished) return NoResult{"nobody finished"};
  if (!(result.variance > 0.0)) return NoResult{"the groups are never followed together when someone finishes"};
  result.z = (result.observed - result.expected) / std::sqrt(result.variance);
  result.p = normalTwoSided(result.z);
  return result;
}

Expected<WorstRank> worstRank(std::span<const CensoredTime> x, std::span<const CensoredTime> y, Hypothesis hypothesis,
                              double level) {
  if (const std::string reason = objection(x, y); !reason.empty()) return NoResult{reason};
  double longest = 0.0;
  for (const auto group : {x, y}) {
    for (const CensoredTime& t : group) longest = std::max(longest, t.time);
  }
  const std::vector<double> a = ranked(x, 2.0 * longest), b = ranked(y, 2.0 * longest);
  const Expected<MannWhitney> test = mannWhitney(a, b);
  if (!test) return NoResult{test.reason()};
  const Expected<SuperiorityEstimate> effect = estimateSuperiority(a, b, hypothesis, level);
  if (!effect) return NoResult{effect.reason()};
  return WorstRank{*test, *effect};
}

namespace {

/// First time at which the curve is at most one half; midway to the next one where it is one half there.
std::optional<double> crossingOfHalf(const std::vector<SurvivalStep>& steps,
                                     const std::function<double(std::size_t)>& curve) {
  constexpr double tolerance = 1e-12;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double share = curve(i);
    if (share > 0.5 + tolerance) continue;
    if (share < 0.5 - tolerance) return steps[i].time;
    for (std::size_t next = i + 1; next < steps.size(); ++next) {
      if (curve(next) < 0.5 - tolerance) return 0.5 * (steps[i].time + steps[next].time);
    }
    return steps[i].time;
  }
  return std::nullopt;
}

}  // namespace

Expected<KaplanMeier> kaplanMeier(std::span<const CensoredTime> times, double level) {
  if (times.empty()) return NoResult{"the group is empty"};
  for (const CensoredTime& t : times) {
    if (!(t.time > 0.0) || !std::isfinite(t.time)) return NoResult{"a time is not positive"};
  }
  std::vector<CensoredTime> sorted(times.begin(), times.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  KaplanMeier result;
  result.people = sorted.size();
  result.level = level;
  std::vector<double> greenwood;
  double share = 1.0, variance = 0.0;
  for (std::size_t first = 0; first < sorted.size();) {
    std::size_t next = first, finished = 0;
    for (; next < sorted.size() && sorted[next].time == sorted[first].time; ++next)
      finished += sorted[next].finished ? 1 : 0;
    const double followed = static_cast<double>(sorted.size() - first), d = static_cast<double>(finished);
    if (finished > 0) {
      share *= (followed - d) / followed;
      variance += d / (followed * (followed - d));  // infinite where all that are left finish
      result.steps.push_back({sorted[first].time, followed, d, share});
      greenwood.push_back(variance);
      result.finished += finished;
    }
    first = next;
  }
  if (result.finished == 0) return NoResult{"nobody finished"};
  const double z = normalQuantile(0.5 + level / 2.0);
  const auto limit = [&](std::size_t i, double sign) {
    const double s = result.steps[i].unfinished;
    if (s <= 0.0) return std::nan("");  // no variance there
    const double logS = std::log(s);
    return std::exp(-std::exp(std::log(-logS) + sign * z * std::sqrt(greenwood[i]) / std::abs(logS)));
  };
  result.median = crossingOfHalf(result.steps, [&](std::size_t i) { return result.steps[i].unfinished; });
  const auto bound = [&](double sign) {
    return crossingOfHalf(result.steps, [&](std::size_t i) {
      const double l = limit(i, sign);
      return std::isnan(l) ? HUGE_VAL : l;
    });
  };
  result.lower = bound(1.0);  // the lower limit of the curve falls below one half first
  result.upper = bound(-1.0);
  return result;
}

bool meets(double value, double criterion, Better better) {
  return better == Better::lower ? value <= criterion : value >= criterion;
}

CensoredTime attemptsToCriterion(std::span<const double> values, double criterion, Better better, std::size_t run) {
  assert(!values.empty() && run > 0);
  std::size_t met = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    met = meets(values[i], criterion, better) ? met + 1 : 0;
    if (met == run) return {static_cast<double>(i + 1), true};
  }
  return {static_cast<double>(values.size()), false};
}

}  // namespace calot::analytics

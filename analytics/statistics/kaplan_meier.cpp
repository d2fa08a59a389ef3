// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/kaplan_meier.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "analytics/statistics/distributions.h"

namespace calot::analytics {
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
  using Result = Expected<KaplanMeier>;
  if (times.empty()) return Result::none("the group is empty");
  for (const CensoredTime& t : times) {
    if (!(t.time > 0.0) || !std::isfinite(t.time)) return Result::none("a time is not positive");
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
  if (result.finished == 0) return Result::none("nobody finished");
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

}  // namespace calot::analytics

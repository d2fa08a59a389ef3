// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/censored_times.h"

#include <algorithm>
#include <cmath>
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
  using Result = Expected<LogRank>;
  if (const std::string reason = objection(x, y); !reason.empty()) return Result::none(reason);
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
  if (!anyFinished) return Result::none("nobody finished");
  if (!(result.variance > 0.0)) return Result::none("the groups are never followed together when someone finishes");
  result.z = (result.observed - result.expected) / std::sqrt(result.variance);
  result.p = normalTwoSided(result.z);
  return result;
}

Expected<WorstRank> worstRank(std::span<const CensoredTime> x, std::span<const CensoredTime> y, Hypothesis hypothesis,
                              double level) {
  using Result = Expected<WorstRank>;
  if (const std::string reason = objection(x, y); !reason.empty()) return Result::none(reason);
  double longest = 0.0;
  for (const auto group : {x, y}) {
    for (const CensoredTime& t : group) longest = std::max(longest, t.time);
  }
  const std::vector<double> a = ranked(x, 2.0 * longest), b = ranked(y, 2.0 * longest);
  const Expected<MannWhitney> test = mannWhitney(a, b);
  if (!test) return Result::none(test.reason());
  const Expected<SuperiorityEstimate> effect = estimateSuperiority(a, b, hypothesis, level);
  if (!effect) return Result::none(effect.reason());
  return WorstRank{*test, *effect};
}

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/simulation_range.h"

#include <map>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

/// Each participant's mean of one end of the intervals.
std::vector<double> meansOf(const std::vector<RangedValue>& values, bool upper) {
  std::map<std::size_t, std::pair<double, double>> sums;  // sum and count
  for (const RangedValue& v : values) {
    auto& [sum, count] = sums[v.participant];
    sum += upper ? v.interval->second : v.interval->first;
    count += 1.0;
  }
  std::vector<double> means;
  for (const auto& [participant, sum] : sums) means.push_back(sum.first / sum.second);
  return means;
}

}  // namespace

std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups) {
  SimulationRange range;
  std::vector<double> halves;
  for (const auto& group : groups) {
    for (const RangedValue& v : group) {
      ++range.values;
      if (!v.interval) continue;
      ++range.known;
      halves.push_back(0.5 * (v.interval->second - v.interval->first));
    }
  }
  if (range.known == 0 || groups[0].empty() || groups[1].empty()) return std::nullopt;
  range.halfWidth = *median(halves);
  if (range.known < range.values) return range;
  const auto least = superiority(meansOf(groups[0], false), meansOf(groups[1], true));
  const auto most = superiority(meansOf(groups[0], true), meansOf(groups[1], false));
  if (least && most) range.area = {least->a, most->a};
  return range;
}

}  // namespace calot::analytics

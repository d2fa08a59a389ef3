// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/simulation_range.h"

#include <algorithm>
#include <map>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

/// Each participant's mean in a world.
std::vector<double> meansIn(std::size_t world, const std::vector<RangedValue>& values) {
  std::map<std::size_t, std::pair<double, double>> sums;  // sum and count
  for (const RangedValue& v : values) {
    auto& [sum, count] = sums[v.participant];
    sum += v.worlds[world];
    count += 1.0;
  }
  std::vector<double> means;
  means.reserve(sums.size());
  for (const auto& [participant, sum] : sums) means.push_back(sum.first / sum.second);
  return means;
}

}  // namespace

std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups) {
  SimulationRange range;
  std::vector<double> halves;
  std::size_t worlds = 0;
  bool alike = true;
  for (const auto& group : groups) {
    for (const RangedValue& v : group) {
      ++range.values;
      if (v.worlds.empty()) continue;
      ++range.known;
      halves.push_back(v.halfWidth);
      alike = alike && (worlds == 0 || worlds == v.worlds.size());
      worlds = v.worlds.size();
    }
  }
  if (range.known == 0 || groups[0].empty() || groups[1].empty()) return std::nullopt;
  range.halfWidth = *median(halves);
  if (range.known < range.values || !alike) return range;
  for (std::size_t w = 0; w < worlds; ++w) {
    const auto here = superiority(meansIn(w, groups[0]), meansIn(w, groups[1]));
    if (!here) continue;
    if (!range.area) range.area = {here->a, here->a};
    range.area->first = std::min(range.area->first, here->a);
    range.area->second = std::max(range.area->second, here->a);
  }
  return range;
}

}  // namespace calot::analytics

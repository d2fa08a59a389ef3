// SPDX-License-Identifier: GPL-3.0-or-later
// Does the difference between two groups stand, wherever in their intervals the exact values lie?
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace calot::analytics {

/// Of a row of a study, in its display unit.
struct SimulationRange {
  std::uint64_t known = 0, values = 0;  ///< attempts' values that have an interval, and all of them
  double halfWidth = 0.0;               ///< median over the intervals
  /// Where every value has one: P(first group larger) + P(equal) / 2 with the first group's values at their lower ends
  /// and the second's at their upper ends, and the other way round. Errors that all attempts share shift both groups
  /// alike, so that this range is too wide rather than too narrow.
  std::optional<std::pair<double, double>> area;

  /// The same group has the larger values throughout the range, or the range is a point.
  [[nodiscard]] bool decided() const {
    return area && (area->first > 0.5 || area->second < 0.5 || area->first == area->second);
  }
};

/// One attempt's value and its interval.
struct RangedValue {
  std::size_t participant = 0;
  double value = 0.0;
  std::optional<std::pair<double, double>> interval;
};

/// Means over each participant's attempts are compared. Nothing where no value has an interval, or a group is empty.
std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups);

}  // namespace calot::analytics

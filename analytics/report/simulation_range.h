// SPDX-License-Identifier: GPL-3.0-or-later
// Does the difference between two groups stand in every simulation that was tried?
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace calot::analytics {

/// Of a row of a study, in its display unit.
struct SimulationRange {
  std::uint64_t known = 0, values = 0;  ///< attempts' values that have an interval, and all of them
  double halfWidth = 0.0;               ///< median over the intervals
  /// Where every value has one: least and largest P(first group larger) + P(equal) / 2 over the worlds
  /// (ValueInterval::worlds()), in each of which all attempts have the same step, mesh and constants.
  std::optional<std::pair<double, double>> area;

  /// The same group has the larger values in every world, or A is the same in all.
  [[nodiscard]] bool decided() const {
    return area && (area->first > 0.5 || area->second < 0.5 || area->first == area->second);
  }
};

/// One attempt's value in every world.
struct RangedValue {
  std::size_t participant = 0;
  double halfWidth = 0.0;
  std::vector<double> worlds;  ///< empty: it has no interval
};

/// Means over each participant's attempts are compared. Nothing where no value has an interval, or a group is empty.
std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups);

}  // namespace calot::analytics

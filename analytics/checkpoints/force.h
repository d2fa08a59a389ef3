// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "recorder/observer.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

/// Below this a force counts as none (N): an operator can't feel it, and no device sends it.
inline constexpr double leastForce = 0.01;

/// Magnitudes of the forces that the haptic ticks sent to the hands, tick by tick.
class ForceTrack {
 public:
  void add(const recorder::StepRecord& record);
  [[nodiscard]] bool mounted(int hand) const { return mounted_[static_cast<std::size_t>(hand)]; }
  /// Those of at least leastForce (N), in the order of ticks.
  [[nodiscard]] const std::vector<double>& felt(int hand) const { return felt_[static_cast<std::size_t>(hand)]; }
  /// The largest of all (N), felt or not.
  [[nodiscard]] double largest(int hand) const { return largest_[static_cast<std::size_t>(hand)]; }

 private:
  std::array<bool, handCount> mounted_{};
  std::array<double, handCount> largest_{};
  std::array<std::vector<double>, handCount> felt_;
};

}  // namespace calot::analytics

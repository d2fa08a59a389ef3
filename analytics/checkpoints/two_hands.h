// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of both hands together.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analytics/checkpoints/motion.h"

namespace calot::analytics {

/// A stretch of the grid in which both hands are measured, the right one `lag` points later: speed i of the left hand
/// beside that of the right hand `lag` points after it. Views into the motions.
struct CommonPart {
  const double* left = nullptr;
  const double* right = nullptr;
  std::size_t points = 0;
};
std::vector<CommonPart> commonParts(const Motion& left, const Motion& right, std::int64_t lag);

/// Pearson's correlation of both hands' speeds, the right one taken `lag` points later.
struct LaggedCorrelation {
  double correlation = 0.0;
  std::int64_t lag = 0;
};
/// At lag 0. @return nothing where there are fewer than 2 common points or a speed does not vary (by minSpeed).
std::optional<double> speedCorrelation(const Motion& left, const Motion& right, std::int64_t lag = 0);
/// The greatest within +-`farthest` points; the smallest lag of equals, the negative one first.
std::optional<LaggedCorrelation> greatestSpeedCorrelation(const Motion& left, const Motion& right,
                                                          std::int64_t farthest);

}  // namespace calot::analytics

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/report/drawing.h"

namespace calot::analytics {

struct BoxPlot {
  std::string title, axis;  ///< axis: what the values are, with their unit
  std::array<std::string, 2> groups;
  std::array<std::span<const double>, 2> values;
  bool synthetic = false;  ///< watermarked
};

/// For each group a box from quartile to quartile (type 7) with the median, whiskers to the outermost
/// values within 1.5 times the box's height (Tukey 1977), and every value as a point beside it; of fewer than five
/// values the points alone, of over 200 one in so many in order, with both extremes, which is said. Values too large or
/// too close for a scale are answered with none, as are two empty groups.
std::optional<Drawing> drawBoxPlot(const BoxPlot& plot);

/// Four to nine round numbers (1, 2 or 5 times a power of ten apart) that lie within [low, high].
/// @pre low < high, finite
std::vector<double> roundTicks(double low, double high);

}  // namespace calot::analytics

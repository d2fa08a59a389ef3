// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/plots.h"

namespace calot::analytics {

/// One line, or points, of a plot.
struct PlotSeries {
  std::string label;                              ///< in the legend, or empty
  std::size_t ink = 0;                            ///< 0, 1, and 2 for all others
  std::vector<std::pair<double, double>> points;  ///< x, y
  bool joined = true;                             ///< a line; else points alone
  bool stepped = false;                           ///< a line that keeps its y until the next x
};

struct LinePlot {
  std::string title, axis, below;  ///< axis: the unit of y, or empty; below: what x is
  std::vector<PlotSeries> series;
  std::vector<double> marks;  ///< of y, drawn as dashed lines
  bool synthetic = false;
  PlotFrame frame = {};
};

/// Values over another quantity. None where there are no points, or they are too large or too close for a scale.
std::optional<Drawing> drawLines(const LinePlot& plot);

}  // namespace calot::analytics
